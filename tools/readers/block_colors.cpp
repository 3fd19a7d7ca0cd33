// What blocks of Minecraft and Minetest look like: one plain colour of this project's own a kind of block. A name is
// stripped of what stands before the first colon and in brackets, and the first entry of a table whose word is part of it
// gives the colour; a colour's name in front (`light_blue_wool`) gives that. Numbers of blocks from before names (0 to
// 255) have a table of names.
#include "readers/formats.h"

namespace thimble::tools {
namespace {

struct Entry {
  std::string_view word;
  Rgb color;
};

/// Dyes in the order of their numbers.
constexpr std::array<Entry, 16> kDyes{{{"white", {233, 236, 236}},
                                       {"orange", {240, 118, 19}},
                                       {"magenta", {189, 68, 179}},
                                       {"light_blue", {58, 175, 217}},
                                       {"yellow", {248, 198, 39}},
                                       {"lime", {112, 185, 25}},
                                       {"pink", {237, 141, 172}},
                                       {"gray", {62, 68, 71}},
                                       {"light_gray", {142, 142, 134}},
                                       {"cyan", {21, 137, 145}},
                                       {"purple", {121, 42, 172}},
                                       {"blue", {53, 57, 157}},
                                       {"brown", {114, 71, 40}},
                                       {"green", {84, 109, 27}},
                                       {"red", {161, 39, 34}},
                                       {"black", {24, 24, 28}}}};
constexpr std::array<std::string_view, 9> kDyed{"wool",   "concrete", "terracotta", "stained", "carpet",
                                                "banner", "_bed",     "shulker",    "candle"};
constexpr std::array<std::string_view, 7> kInvisible{"air",     "cave_air",       "void_air", "ignore",
                                                     "barrier", "structure_void", "light"};

/// The first word that is part of a name decides, so what is special stands before what is common.
constexpr auto kBlockKinds = std::to_array<Entry>({
    // Plants before the wood and earth that they are named after.
    {"cherry_leaves", {229, 172, 194}},
    {"blueberry", {62, 98, 58}},
    {"leaves", {62, 116, 40}},
    {"needles", {44, 84, 50}},
    {"sapling", {86, 134, 52}},
    {"vine", {58, 106, 34}},
    {"lily", {38, 104, 48}},
    {"cactus", {72, 118, 46}},
    {"papyrus", {126, 166, 78}},
    {"reed", {140, 184, 98}},
    {"sugar_cane", {140, 184, 98}},
    {"bamboo", {110, 146, 42}},
    {"fern", {80, 122, 50}},
    {"tall_grass", {92, 140, 58}},
    {"short_grass", {92, 140, 58}},
    {"tallgrass", {92, 140, 58}},
    {"jungle_grass", {78, 130, 48}},
    {"dandelion", {240, 214, 46}},
    {"poppy", {196, 44, 36}},
    {"rose", {196, 44, 36}},
    {"tulip", {216, 112, 60}},
    {"flower", {214, 120, 140}},
    {"wheat", {202, 176, 82}},
    {"crop", {120, 152, 52}},
    {"carrot", {120, 152, 52}},
    {"potato", {120, 152, 52}},
    {"hay", {190, 158, 36}},
    {"apple", {200, 40, 36}},
    {"pumpkin", {208, 126, 30}},
    {"jack_o", {232, 152, 40}},
    {"melon", {122, 154, 42}},
    {"brown_mushroom", {146, 110, 82}},
    {"mushroom", {190, 48, 42}},
    {"coral", {200, 88, 150}},
    {"moss", {92, 112, 48}},
    {"kelp", {70, 108, 42}},
    // Light and fire.
    {"redstone_lamp", {186, 124, 74}},
    {"glowstone", {246, 206, 126}},
    {"sea_lantern", {196, 222, 214}},
    {"lantern", {246, 196, 98}},
    {"torch", {252, 206, 92}},
    {"meselamp", {250, 238, 160}},
    {"campfire", {232, 130, 46}},
    {"fire", {240, 138, 34}},
    {"lava", {222, 92, 20}},
    {"magma", {140, 62, 30}},
    // Water, ice, glass.
    {"water", {58, 104, 196}},
    {"blue_ice", {116, 168, 248}},
    {"ice", {156, 190, 244}},
    {"snow", {244, 250, 250}},
    {"glass", {196, 224, 232}},
    // Ores and what is made of them.
    {"diamond", {106, 220, 212}},
    {"emerald", {50, 194, 98}},
    {"lapis", {36, 70, 146}},
    {"redstone", {172, 26, 14}},
    {"gold", {244, 206, 66}},
    {"copper", {190, 106, 78}},
    {"coal", {42, 42, 44}},
    {"quartz", {234, 228, 220}},
    {"amethyst", {134, 98, 190}},
    {"mese", {232, 222, 60}},
    {"iron_ore", {164, 142, 130}},
    {"iron", {214, 214, 212}},
    {"anvil", {72, 72, 76}},
    {"cauldron", {72, 72, 76}},
    {"rail", {128, 118, 106}},
    {"chain", {60, 66, 78}},
    // Earth and stone.
    {"nether_brick", {46, 22, 28}},
    {"netherrack", {104, 44, 44}},
    {"nether", {90, 30, 34}},
    {"soul", {84, 64, 52}},
    {"end_stone", {220, 222, 160}},
    {"purpur", {168, 124, 168}},
    {"obsidian", {24, 18, 36}},
    {"bedrock", {74, 74, 76}},
    {"prismarine", {98, 156, 146}},
    {"deepslate", {80, 80, 84}},
    {"blackstone", {44, 38, 46}},
    {"basalt", {82, 82, 88}},
    {"andesite", {136, 136, 138}},
    {"diorite", {188, 188, 190}},
    {"granite", {150, 104, 86}},
    {"red_sand", {188, 100, 34}},
    {"sandstone", {216, 204, 156}},
    {"sand", {220, 208, 164}},
    {"gravel", {132, 126, 124}},
    {"clay", {160, 166, 178}},
    {"terracotta", {152, 94, 68}},
    {"stone_brick", {122, 122, 122}},
    {"brick", {150, 96, 82}},
    {"mycelium", {112, 100, 106}},
    {"podzol", {92, 64, 26}},
    {"grass", {98, 148, 62}},
    {"path", {148, 122, 66}},
    {"farmland", {100, 66, 38}},
    {"dirt", {134, 96, 66}},
    {"mud", {62, 58, 62}},
    {"cobble", {118, 118, 118}},
    {"stone", {126, 126, 126}},
    {"bookshelf", {150, 112, 66}},
    {"sponge", {196, 192, 74}},
    {"tnt", {190, 62, 50}},
    {"slime", {112, 188, 92}},
});

/// Woods, for planks and all that is made of them; the darker bark for trunks.
struct Wood {
  std::string_view word;
  Rgb planks, bark;
};
constexpr std::array<Wood, 12> kWoods{{{"dark_oak", {66, 44, 22}, {60, 46, 28}},
                                       {"spruce", {114, 84, 50}, {58, 38, 18}},
                                       {"birch", {192, 174, 122}, {216, 214, 206}},
                                       {"jungle", {160, 114, 80}, {86, 68, 26}},
                                       {"acacia", {168, 90, 50}, {104, 96, 88}},
                                       {"mangrove", {118, 54, 48}, {84, 66, 40}},
                                       {"cherry", {226, 178, 172}, {54, 32, 42}},
                                       {"crimson", {100, 48, 70}, {92, 26, 30}},
                                       {"warped", {42, 104, 98}, {58, 58, 76}},
                                       {"aspen", {206, 194, 160}, {222, 218, 208}},
                                       {"pine", {196, 150, 96}, {96, 70, 46}},
                                       {"", {162, 130, 78}, {108, 84, 50}}}};  // oak and the like
constexpr std::array<std::string_view, 4> kTrunks{"log", "tree", "stem", "trunk"};
constexpr std::array<std::string_view, 15> kWooden{"plank",  "wood",   "fence",  "door",    "chest",
                                                   "ladder", "sign",   "stairs", "slab",    "craft",
                                                   "gate",   "barrel", "table",  "lectern", "loom"};

constexpr Rgb kGrey{150, 150, 150};

bool has(std::string_view name, std::string_view word) {
  return name.find(word) != std::string_view::npos;
}

template <std::size_t kCount>
bool has_any(std::string_view name, const std::array<std::string_view, kCount>& words) {
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) { return has(name, word); });
}

/// Names of the blocks from number 0 on, those behind the last as that; a dash is as the one before.
constexpr std::string_view kBlocksByNumber =
    "air stone grass dirt cobble plank sapling bedrock water - lava - sand gravel gold iron_ore coal "
    "log leaves sponge glass lapis - cobble sandstone plank red_bed rail - cobble iron tall_grass - "
    "cobble - wool air dandelion poppy brown_mushroom mushroom gold iron stone - brick tnt bookshelf "
    "moss obsidian torch fire iron_ore plank - redstone diamond - plank wheat farmland cobble - plank "
    "- - rail cobble plank cobble - iron plank redstone - torch - stone snow ice snow cactus clay "
    "reed plank - pumpkin netherrack soul glowstone purple_stained jack_o snow stone - stained plank "
    "stone_brick - brown_mushroom mushroom iron glass melon crop - vine plank brick stone_brick "
    "mycelium lily nether_brick - - nether obsidian iron_ore cauldron obsidian - end_stone obsidian "
    "redstone_lamp - plank - crop sandstone emerald obsidian iron - emerald spruce_plank birch_plank "
    "jungle_plank brown_wool glass cobble brick crop - plank white_wool anvil plank gold iron stone - "
    "- redstone netherrack iron quartz - rail cobble terracotta stained leaves acacia_log "
    "acacia_plank dark_oak_plank slime barrier iron prismarine sea_lantern hay carpet terracotta coal "
    "ice flower wool - - red_sand - - - plank";
constexpr std::size_t kBlockNumbers = 184;

constexpr std::array<std::string_view, kBlockNumbers> names_by_number() {
  std::array<std::string_view, kBlockNumbers> names{};
  std::string_view rest = kBlocksByNumber;
  for (std::size_t i = 0; i < kBlockNumbers; ++i) {
    const std::string_view word = rest.substr(0, rest.find(' '));
    names[i] = word == "-" ? names[i - 1] : word;
    rest.remove_prefix(word.size() + (word.size() < rest.size() ? 1 : 0));
  }
  return names;
}

}  // namespace

std::optional<Rgb> block_color(std::string_view name) {
  name = name.substr(0, name.find('['));
  name.remove_prefix(name.find(':') + 1);  // of none all stays
  if (std::find(kInvisible.begin(), kInvisible.end(), name) != kInvisible.end()) {
    return std::nullopt;
  }
  if (has_any(name, kDyed)) {
    // "light_blue" before "blue".
    const Entry* dye = nullptr;
    for (const Entry& each : kDyes) {
      const bool is_longer = dye == nullptr || each.word.size() > dye->word.size();
      dye = name.starts_with(each.word) && is_longer ? &each : dye;
    }
    if (dye != nullptr) {
      return dye->color;
    }
  }
  for (const Entry& kind : kBlockKinds) {
    if (has(name, kind.word)) {
      return kind.color;
    }
  }
  const bool is_trunk = has_any(name, kTrunks);
  for (const Wood& wood : kWoods) {
    if (has(name, wood.word) && (is_trunk || !wood.word.empty() || has_any(name, kWooden))) {
      return is_trunk ? wood.bark : wood.planks;
    }
  }
  return has(name, "wool") ? kDyes.front().color : kGrey;
}

std::optional<Rgb> block_color(unsigned number, unsigned data) {
  constexpr std::array<unsigned, 5> kByDye{35, 95, 159, 160, 171};
  if (std::find(kByDye.begin(), kByDye.end(), number) != kByDye.end()) {
    return kDyes[data & 15U].color;
  }
  static constexpr auto kNames = names_by_number();
  return block_color(kNames[std::min<std::size_t>(number, kBlockNumbers - 1)]);
}

}  // namespace thimble::tools
