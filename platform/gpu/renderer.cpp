#include "gpu/renderer.h"

#include <lit_pairs_spv.h>
#include <lit_spv.h>
#include <octree_pairs_spv.h>
#include <octree_spv.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "gpu/device.h"
#include "gpu/kernel/parameters.h"
#include "thimble/light/host/asked.h"

namespace thimble::gpu {
namespace {

// The output of a frame under way: every device lets a kernel see as much.
constexpr std::size_t kMostOutputBytes = std::size_t{1} << 27;
constexpr std::size_t kUploadBytes = std::size_t{1} << 26;
constexpr std::uint32_t kRaysAtATime = std::uint32_t{1} << 20;
constexpr std::uint32_t kRaysARow = 1024;
constexpr std::uint32_t kGroupSide = 8;  // threads of a group; kernel/frame.comp has it too
constexpr std::uint64_t kForever = UINT64_MAX;

// Kernels as SPIR-V: of lit pictures behind the others, in pairs of words behind those in words.
constexpr std::span<const std::uint32_t> kKernels[] = {octree_spv, octree_pairs_spv, lit_spv, lit_pairs_spv};

void begin_once(VkCommandBuffer commands) {
  auto info = vulkan<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  require(vkBeginCommandBuffer(commands, &info), "take commands");
}

void submit(const Device& device, VkCommandBuffer commands, VkFence fence, const char* what) {
  require(vkEndCommandBuffer(commands), "take commands");
  auto info = vulkan<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  require(vkQueueSubmit(device.queue(), 1, &info, fence), what);
}

void wait_for(VkCommandBuffer commands, VkAccessFlags written, VkPipelineStageFlags by, VkAccessFlags read,
              VkPipelineStageFlags before) {
  auto barrier = vulkan<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  barrier.srcAccessMask = written;
  barrier.dstAccessMask = read;
  vkCmdPipelineBarrier(commands, by, before, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

// A frame under way.
struct Slot {
  Buffer parameters;
  Buffer output;
  Buffer host;  // what of the output is read back, or was written for it
  VkDescriptorSet descriptors = VK_NULL_HANDLE;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
  bool reads_back = false;
};

}  // namespace

struct Renderer::State {
  State(const CompactTree& tree, Span<const Rgb8> palette, const Options& chosen) : options(chosen) {
    SceneWords words = make_scene_words(tree);
    set_palette(palette, words.words.data());
    level = words.level;
    parameters = words.parameters;
    try {
      make_layouts();
      slots.resize(static_cast<std::size_t>(std::max(options.frames, 1)));
      for (Slot& slot : slots) {
        make(&slot);
      }
      upload(words.words);
    } catch (const DeviceError&) {
      release();
      throw;
    }
  }

  ~State() { release(); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  // By way of memory that both see, a part at a time.
  void upload(const std::vector<std::uint32_t>& words) {
    const std::size_t bytes = 4 * words.size();
    if (bytes > device.most_bytes()) {
      throw DeviceError("the scene takes " + std::to_string(bytes) + " bytes, and a kernel of " +
                        device.info().name + " sees at most " + std::to_string(device.most_bytes()));
    }
    try {
      scene = device.make_buffer(bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                 Memory::kDevice);
    } catch (const DeviceError&) {
      throw DeviceError("the scene takes " + std::to_string(bytes) + " bytes, more than " +
                        device.info().name + " has free");
    }
    const std::size_t part = std::min(bytes, kUploadBytes);
    const Buffer from = device.make_buffer(part, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Memory::kReadBack);
    VkCommandBuffer copy = slots[0].commands;
    for (std::size_t first = 0; first < bytes; first += part) {
      const std::size_t size = std::min(part, bytes - first);
      std::memcpy(from.words(), words.data() + first / 4, size);
      begin_once(copy);
      const VkBufferCopy region{0, first, size};
      vkCmdCopyBuffer(copy, from.get(), scene.get(), 1, &region);
      submit(device, copy, VK_NULL_HANDLE, "take the scene");
      require(vkQueueWaitIdle(device.queue()), "take the scene");
    }
  }

  void make_layouts() {
    VkDescriptorSetLayoutBinding bindings[3]{};
    for (std::uint32_t i = 0; i < 3; ++i) {
      bindings[i].binding = i;
      bindings[i].descriptorType =
          i == 0 ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
      bindings[i].descriptorCount = 1;
      bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    }
    auto set = vulkan<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    set.bindingCount = 3;
    set.pBindings = bindings;
    require(vkCreateDescriptorSetLayout(device.get(), &set, nullptr, &set_layout),
            "take the kernel's layout");
    auto info = vulkan<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
    info.setLayoutCount = 1;
    info.pSetLayouts = &set_layout;
    require(vkCreatePipelineLayout(device.get(), &info, nullptr, &layout), "take the kernel's layout");
    const auto frames = static_cast<std::uint32_t>(std::max(options.frames, 1));
    const VkDescriptorPoolSize sizes[2] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, frames},
                                           {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2 * frames}};
    auto pool = vulkan<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
    pool.maxSets = frames;
    pool.poolSizeCount = 2;
    pool.pPoolSizes = sizes;
    require(vkCreateDescriptorPool(device.get(), &pool, nullptr, &descriptors), "take the kernel's layout");
    auto command_pool = vulkan<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
    command_pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    command_pool.queueFamilyIndex = device.family();
    require(vkCreateCommandPool(device.get(), &command_pool, nullptr, &commands), "take commands");
    if (device.tick_seconds() > 0) {
      auto query = vulkan<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
      query.queryType = VK_QUERY_TYPE_TIMESTAMP;
      query.queryCount = 2 * frames;
      require(vkCreateQueryPool(device.get(), &query, nullptr, &queries), "keep the time");
    }
  }

  void make(Slot* slot) {
    slot->parameters =
        device.make_buffer(sizeof(Parameters), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, Memory::kWritten);
    auto set = vulkan<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
    set.descriptorPool = descriptors;
    set.descriptorSetCount = 1;
    set.pSetLayouts = &set_layout;
    require(vkAllocateDescriptorSets(device.get(), &set, &slot->descriptors), "take the kernel's layout");
    auto info = vulkan<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    info.commandPool = commands;
    info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    info.commandBufferCount = 1;
    require(vkAllocateCommandBuffers(device.get(), &info, &slot->commands), "take commands");
    auto fence = vulkan<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
    require(vkCreateFence(device.get(), &fence, nullptr, &slot->fence), "take commands");
  }

  VkPipeline pipeline(bool lit, bool pairs) {
    const std::size_t number = (lit ? 2U : 0U) + (pairs ? 1U : 0U);
    VkPipeline& made = pipelines[number];
    if (made != VK_NULL_HANDLE) {
      return made;
    }
    auto module = vulkan<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
    module.codeSize = kKernels[number].size_bytes();
    module.pCode = kKernels[number].data();
    VkShaderModule shader = VK_NULL_HANDLE;
    require(vkCreateShaderModule(device.get(), &module, nullptr, &shader), "take the kernel");
    auto info = vulkan<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = shader;
    info.stage.pName = "main";
    info.layout = layout;
    const VkResult result = vkCreateComputePipelines(device.get(), VK_NULL_HANDLE, 1, &info, nullptr, &made);
    vkDestroyShaderModule(device.get(), shader, nullptr);
    require(result, "compile the kernel");
    return made;
  }

  // Makes the slot's buffers large enough, and tells the kernel where they are.
  void fit(Slot* slot, std::size_t bytes) {
    if (slot->output.size() >= bytes) {
      return;
    }
    slot->output = {};
    slot->host = {};
    constexpr VkBufferUsageFlags kCopied =
        VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    slot->output = device.make_buffer(bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | kCopied, Memory::kDevice);
    slot->host = device.make_buffer(bytes, kCopied, Memory::kReadBack);
    const VkDescriptorBufferInfo buffers[3] = {{slot->parameters.get(), 0, VK_WHOLE_SIZE},
                                               {scene.get(), 0, VK_WHOLE_SIZE},
                                               {slot->output.get(), 0, VK_WHOLE_SIZE}};
    VkWriteDescriptorSet writes[3]{};
    for (std::uint32_t i = 0; i < 3; ++i) {
      writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
      writes[i].dstSet = slot->descriptors;
      writes[i].dstBinding = i;
      writes[i].descriptorCount = 1;
      writes[i].descriptorType =
          i == 0 ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
      writes[i].pBufferInfo = &buffers[i];
    }
    vkUpdateDescriptorSets(device.get(), 3, writes, 0, nullptr);
  }

  // Starts a kernel over the width and height of `told`; `in_bytes` of the slot's host memory go to its output
  // first, `out_bytes` come back.
  void start(std::size_t number, const Parameters& told, bool pairs, std::size_t in_bytes,
             std::size_t out_bytes) {
    Slot& slot = slots[number];
    VkPipeline kernel = pipeline(told[kernel::kMode] == kernel::kModeLit, pairs);
    std::memcpy(slot.parameters.words(), told.words, sizeof told);
    slot.reads_back = out_bytes != 0;
    const auto query = static_cast<std::uint32_t>(2 * number);
    begin_once(slot.commands);
    if (queries != VK_NULL_HANDLE) {
      vkCmdResetQueryPool(slot.commands, queries, query, 2);
    }
    if (in_bytes != 0) {
      const VkBufferCopy region{0, 0, in_bytes};
      vkCmdCopyBuffer(slot.commands, slot.host.get(), slot.output.get(), 1, &region);
      wait_for(slot.commands, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
               VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT);
    }
    vkCmdBindPipeline(slot.commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel);
    vkCmdBindDescriptorSets(slot.commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &slot.descriptors, 0,
                            nullptr);
    if (queries != VK_NULL_HANDLE) {
      vkCmdWriteTimestamp(slot.commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, queries, query);
    }
    vkCmdDispatch(slot.commands, (told[kernel::kWidth] + kGroupSide - 1) / kGroupSide,
                  (told[kernel::kHeight] + kGroupSide - 1) / kGroupSide, 1);
    if (queries != VK_NULL_HANDLE) {
      vkCmdWriteTimestamp(slot.commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, queries, query + 1);
    }
    if (out_bytes != 0) {
      wait_for(slot.commands, VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
               VK_ACCESS_TRANSFER_READ_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT);
      const VkBufferCopy region{0, 0, out_bytes};
      vkCmdCopyBuffer(slot.commands, slot.output.get(), slot.host.get(), 1, &region);
      wait_for(slot.commands, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
               VK_ACCESS_HOST_READ_BIT, VK_PIPELINE_STAGE_HOST_BIT);
    }
    submit(device, slot.commands, slot.fence, "draw");
  }

  double finish(std::size_t number) {
    Slot& slot = slots[number];
    require(vkWaitForFences(device.get(), 1, &slot.fence, VK_TRUE, kForever), "draw");
    require(vkResetFences(device.get(), 1, &slot.fence), "draw");
    if (queries == VK_NULL_HANDLE) {
      return 0;
    }
    std::uint64_t ticks[2] = {0, 0};
    require(
        vkGetQueryPoolResults(device.get(), queries, static_cast<std::uint32_t>(2 * number), 2, sizeof ticks,
                              ticks, sizeof ticks[0], VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "keep the time");
    return static_cast<double>(ticks[1] - ticks[0]) * device.tick_seconds();
  }

  // Starts a frame of a word a pixel.
  void begin(int frame, const Camera& camera, const Parameters& told, bool pairs, bool read_back) {
    const std::size_t bytes = std::size_t{4} * static_cast<std::size_t>(camera.width_px()) *
                              static_cast<std::size_t>(camera.height_px());
    const auto number = static_cast<std::size_t>(frame);
    fit(&slots[number], bytes);
    start(number, told, pairs, 0, read_back ? bytes : 0);
  }

  // A picture of `part` at once, so many words a pixel.
  const std::uint32_t* draw(const Camera& part, const Parameters& told, bool pairs, std::size_t words) {
    const std::size_t bytes =
        4 * words * static_cast<std::size_t>(part.width_px()) * static_cast<std::size_t>(part.height_px());
    fit(slots.data(), bytes);
    start(0, told, pairs, 0, bytes);
    finish(0);
    return slots[0].host.words();
  }

  void release() {
    vkDeviceWaitIdle(device.get());
    for (Slot& slot : slots) {
      vkDestroyFence(device.get(), slot.fence, nullptr);
    }
    for (VkPipeline made : pipelines) {
      vkDestroyPipeline(device.get(), made, nullptr);
    }
    vkDestroyQueryPool(device.get(), queries, nullptr);
    vkDestroyCommandPool(device.get(), commands, nullptr);
    vkDestroyDescriptorPool(device.get(), descriptors, nullptr);
    vkDestroyPipelineLayout(device.get(), layout, nullptr);
    vkDestroyDescriptorSetLayout(device.get(), set_layout, nullptr);
    slots.clear();
    scene = {};
  }

  const Options options;
  Device device;
  int level = 0;
  Parameters parameters{};
  Buffer scene;
  std::vector<Slot> slots;
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkDescriptorPool descriptors = VK_NULL_HANDLE;
  VkCommandPool commands = VK_NULL_HANDLE;
  VkQueryPool queries = VK_NULL_HANDLE;
  VkPipeline pipelines[std::size(kKernels)] = {};
};

Renderer::Renderer(const CompactTree& tree, Span<const Rgb8> palette, const Options& options)
    : state_(std::make_unique<State>(tree, palette, options)) {}
Renderer::~Renderer() = default;

const DeviceInfo& Renderer::device() const {
  return state_->device.info();
}
std::size_t Renderer::scene_bytes() const {
  return static_cast<std::size_t>(state_->scene.size());
}

std::int32_t Renderer::most_rows(std::int32_t width_px) {
  return static_cast<std::int32_t>(kMostOutputBytes / (4 * kernel::kLitWords)) / std::max(width_px, 1);
}

void Renderer::begin(int frame, const Camera& camera, const Shading& shading, bool read_back) {
  Parameters parameters = state_->parameters;
  set_frame(camera, shading, &parameters);
  state_->begin(frame, camera, parameters, needs_pairs(state_->level, largest_direction(camera)), read_back);
}

void Renderer::begin(int frame, const LitFrame& lit, bool read_back) {
  Parameters parameters = state_->parameters;
  set_frame(lit.camera, lit.shading, &parameters);
  set_light(lit, &parameters);
  state_->begin(frame, lit.camera, parameters, needs_pairs(state_->level, largest_direction(lit)), read_back);
}

Frame Renderer::end(int frame) {
  const auto number = static_cast<std::size_t>(frame);
  Frame ended;
  ended.seconds = state_->finish(number);
  const Slot& slot = state_->slots[number];
  ended.pixels = slot.reads_back ? slot.host.words() : nullptr;
  return ended;
}

namespace {

// Whether the band may be drawn; `stride` gets the bytes from row to row.
Status check_band(const Camera& camera, int level, const Band& band, std::size_t* stride) {
  const std::int32_t width = camera.width_px();
  const std::size_t line = row_bytes(band.format, width);
  *stride = band.stride_bytes != 0 ? band.stride_bytes : line;
  if (width == 0 || camera.level() != level || band.first_row < 0 || band.rows < 0 ||
      band.rows > camera.height_px() - band.first_row || band.rows > Renderer::most_rows(width) ||
      has_pages(band.format) || *stride < line) {
    return Status::kBadArgument;
  }
  return band.rows != 0 && line + *stride * static_cast<std::size_t>(band.rows - 1) > band.pixels.size
             ? Status::kOutOfMemory
             : Status::kOk;
}

// Calls store(line, x, y, words) for each pixel of a band, which the kernel has given so many words.
template <class Store>
void store_all(const std::uint32_t* from, std::size_t words, std::int32_t width, const Band& band,
               std::size_t stride, const Store& store) {
  for (std::int32_t row = 0; row < band.rows; ++row) {
    std::uint8_t* const line = band.pixels.data + stride * static_cast<std::size_t>(row);
    std::memset(line, 0, row_bytes(band.format, width));
    for (std::int32_t x = 0; x < width; ++x, from += words) {
      store(line, x, band.first_row + row, from);
    }
  }
}

Rgb8 color_of(std::uint32_t word) {
  return {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8),
          static_cast<std::uint8_t>(word >> 16)};
}

}  // namespace

Status Renderer::draw(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts) {
  std::size_t stride = 0;
  const Status status = check_band(camera, state_->level, band, &stride);
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  const Camera part = camera.window(0, band.first_row, camera.width_px(), band.rows);
  Parameters parameters = state_->parameters;
  set_frame(part, shading, &parameters);
  parameters[kernel::kWantSteps] = 1;
  const std::uint32_t* const drawn =
      state_->draw(part, parameters, needs_pairs(state_->level, largest_direction(part)), 2);
  RenderCounts all;
  all.rays = static_cast<std::uint64_t>(camera.width_px()) * static_cast<std::uint64_t>(band.rows);
  store_all(drawn, 2, camera.width_px(), band, stride,
            [&](std::uint8_t* line, std::int32_t x, std::int32_t y, const std::uint32_t* words) {
              store_pixel(line, x, y, band.format, color_of(words[0]));
              all.hits += words[1] & 1U;
              all.node_visits += words[1] >> 1;
            });
  if (counts != nullptr) {
    counts->rays += all.rays;
    counts->hits += all.hits;
    counts->node_visits += all.node_visits;
  }
  return Status::kOk;
}

namespace {

Status check_lit(const LitFrame& frame) {
  if ((frame.effects & ~kEffectsInKernels) != 0) {
    return Status::kBadArgument;
  }
  return frame.scene.lights.size > kMaxLights || frame.scene.surfaces.size > kMaxSurfaces
             ? Status::kOutOfRange
             : Status::kOk;
}

}  // namespace

Status Renderer::draw_places(const LitFrame& frame, Span<std::uint32_t> places) {
  const Status status = frame.camera.level() != state_->level ? Status::kBadArgument : check_lit(frame);
  Parameters parameters = state_->parameters;
  set_frame(frame.camera, frame.shading, &parameters);
  set_light(frame, &parameters);
  const bool pairs = needs_pairs(state_->level, largest_direction(frame));
  for (std::size_t first = 0; first < places.size && status == Status::kOk; first += kRaysAtATime) {
    const std::size_t count = std::min<std::size_t>(kRaysAtATime, places.size - first);
    Slot& slot = state_->slots[0];
    state_->fit(&slot, 4 * count);
    std::memcpy(slot.host.words(), places.data + first, 4 * count);
    set_places(static_cast<std::uint32_t>(count), kRaysARow, &parameters);
    state_->start(0, parameters, pairs, 4 * count, 4 * count);
    state_->finish(0);
    std::memcpy(places.data + first, slot.host.words(), 4 * count);
  }
  return status;
}

Status Renderer::draw_lit(const LitFrame& frame, const Band& band, Bytes shares, LitCounts* counts) {
  std::size_t stride = 0;
  Status status = check_band(frame.camera, state_->level, band, &stride);
  status = status != Status::kOk ? status : check_lit(frame);
  if (status != Status::kOk) {
    return status;
  }
  const std::int32_t width = frame.camera.width_px();
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(band.rows);
  if (frame.backdrop != nullptr && shares.size < pixels) {
    return Status::kOutOfMemory;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  const Camera part = frame.camera.window(0, band.first_row, width, band.rows);
  const LitFrame drawn{frame.effects, part, frame.shading, frame.scene, frame.backdrop};
  Parameters parameters = state_->parameters;
  set_frame(part, frame.shading, &parameters);
  set_light(drawn, &parameters);
  // Who counts nothing gets a word a pixel, in 8 bits a channel.
  const bool is_short = counts == nullptr && band.format == PixelFormat::kRgb888;
  const std::size_t each = is_short ? 1 : kernel::kLitWords;
  parameters[kernel::kWantSteps] = is_short ? 0 : 1;
  const std::uint32_t* const from =
      state_->draw(part, parameters, needs_pairs(state_->level, largest_direction(drawn)), each);
  LitCounts all;
  const LitOptions options;
  const CompactTree none;
  const lit::Frame to{none, frame.camera, frame.shading, frame.scene, options, frame.effects};
  std::uint8_t* share = frame.backdrop != nullptr ? shares.data : nullptr;
  store_all(from, each, width, band, stride,
            [&](std::uint8_t* line, std::int32_t x, std::int32_t y, const std::uint32_t* words) {
              if (share != nullptr) {
                *share++ = static_cast<std::uint8_t>(words[is_short ? 0 : 1] >> 24);
              }
              if (is_short) {
                store_pixel(line, x, y, band.format, color_of(words[0]));
                return;
              }
              lit::store(to, band, line, x, y, {{words[0] & 65535U, words[0] >> 16, words[1] & 65535U}});
              all.node_visits[0] += words[2];
              for (int kind = 0; kind < kernel::kCountedRays; ++kind) {
                all.rays[kind] += words[3 + kind] & 65535U;
                all.hits[kind] += words[3 + kind] >> 16;
              }
            });
  if (counts != nullptr) {
    lit::add_counts(all, counts);
  }
  return Status::kOk;
}

Status Renderer::trace(Span<const Ray> rays, Span<Hit> hits) {
  if (hits.size < rays.size) {
    return Status::kBadArgument;
  }
  for (std::size_t i = 0; i < rays.size; ++i) {
    const Status status = check_ray(rays[i], state_->level);
    if (status != Status::kOk) {
      return status;
    }
  }
  constexpr std::size_t kBytes = 4 * std::size_t{kernel::kRecordWords};
  for (std::size_t first = 0; first < rays.size; first += kRaysAtATime) {
    const std::size_t count = std::min<std::size_t>(kRaysAtATime, rays.size - first);
    const Span<const Ray> part{rays.data + first, count};
    Slot& slot = state_->slots[0];
    state_->fit(&slot, kBytes * count);
    for (std::size_t i = 0; i < count; ++i) {
      set_record(part[i], slot.host.words() + kernel::kRecordWords * i);
    }
    Parameters parameters = state_->parameters;
    set_rays(static_cast<std::uint32_t>(count), kRaysARow, &parameters);
    state_->start(0, parameters, needs_pairs(state_->level, largest_direction(part)), kBytes * count,
                  kBytes * count);
    state_->finish(0);
    for (std::size_t i = 0; i < count; ++i) {
      hits[first + i] = hit_of_record(slot.host.words() + kernel::kRecordWords * i);
    }
  }
  return Status::kOk;
}

}  // namespace thimble::gpu
