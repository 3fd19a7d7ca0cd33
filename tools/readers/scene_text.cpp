#include "readers/scene_text.h"

#include <memory>

#include "output/units.h"
#include "readers/formats.h"
#include "readers/scene_statements.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

void depth(TextLine& line, TextPlace, SceneText* scene) {
  scene->depth = line.whole("depth", kMinLevel, kMaxLevel);
}

void bounces(TextLine& line, TextPlace, SceneText* scene) {
  scene->rest.bounces = static_cast<std::uint8_t>(line.whole("bounces", 0, kMaxBounces));
}

struct Statement {
  std::string_view word;
  statements::Read* read;
  bool once;
};

constexpr std::array<Statement, 15> kStatements{{
    {"model", statements::model, false},
    {"box", statements::box, false},
    {"ball", statements::ball, false},
    {"material", statements::material, false},
    {"depth", depth, true},
    {"camera", statements::camera, true},
    {"sun", statements::sun, false},
    {"lamp", statements::lamp, false},
    {"ambient", statements::ambient, true},
    {"sky", statements::sky, true},
    {"fog", statements::fog, true},
    {"occlusion", statements::occlusion, true},
    {"water", statements::water, true},
    {"bounces", bounces, true},
    {"effects", statements::effects, false},
}};

/// Lines in which the statements stand first; 0: nowhere yet.
using FirstLines = std::array<std::uint32_t, kStatements.size()>;

void read_statement(TextLine line, FirstLines* first, SceneText* scene) {
  const Word word = line.word();
  if (word.empty()) {
    return;
  }
  std::string known;
  for (std::size_t i = 0; i < kStatements.size(); ++i) {
    const Statement& statement = kStatements[i];
    if (word.text != statement.word || word.is_quoted) {
      known += (known.empty() ? "" : ", ") + std::string(statement.word);
      continue;
    }
    if (statement.once && (*first)[i] != 0) {
      fail_at(word.place, word.text, " is said twice; the first stands in line ", (*first)[i]);
    }
    (*first)[i] = word.place.line;
    statement.read(line, word.place, scene);
    if (!line.at_end()) {
      const auto place = line.place();  // before the word is read
      fail_at(place, "nothing more belongs into this line, but there is ", quoted(line.word().text));
    }
    return;
  }
  fail_at(word.place, quoted(word.text), " is no statement; there are ", known);
}

}  // namespace

/// @throws InputError  naming line and column: a word that is not known, one that is missing, a number that
///   is none, not finite or out of its range, something said twice, a name that is not defined, more than a
///   limit above, bytes that are not UTF-8; and a file that shows nothing
Source read_scene_text(const SharedBytes& file, const ReadOptions&, const Progress&) {
  std::string_view text = file.text();
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) {
    text.remove_prefix(kMark.size());
  }
  if (text.size() > kSceneTextBytes) {
    throw InputError("holds ", grouped(text.size()), " bytes, the limit of a .scene file is ",
                     grouped(kSceneTextBytes));
  }
  check_characters(text);
  const auto scene = std::make_shared<SceneText>();
  FirstLines first{};
  LineReader lines(text);
  std::string_view line;
  std::uint32_t number = 0;
  while (lines.next(line)) {
    read_statement(TextLine(line, ++number), &first, scene.get());
  }
  if (scene->parts.empty()) {
    fail_at({number, 1}, "the file ends and shows nothing: there is no model, box or ball in it");
  }
  scene->rest.has_shadows = !scene->lights.empty();
  return std::shared_ptr<const SceneText>(scene);
}

}  // namespace thimble::tools
