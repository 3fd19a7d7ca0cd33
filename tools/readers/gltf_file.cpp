#include "readers/gltf_file.h"

#include "output/units.h"
#include "readers/formats.h"

namespace thimble::tools {
namespace {

using nlohmann::json;

constexpr std::uint64_t kGltfValueLimit = std::uint64_t{1} << 19;
constexpr int kGltfDepthLimit = 64;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

/// Of 0 bytes where it is none.
NumberType component_type_of(const json& object, const std::string& place) {
  constexpr std::array<NumberType, 7> kComponentTypes{
      {{'i', 1}, {'u', 1}, {'i', 2}, {'u', 2}, {'u', 0}, {'u', 4}, {'f', 4}}};  // from 5120 on
  const std::uint64_t at = gltf_number(object, "componentType", place).value_or(0) - 5120;
  return at < kComponentTypes.size() ? kComponentTypes[at] : NumberType{'u', 0};
}

/// Counts what a parser would make of the text, so that no text is parsed that makes too much.
void check_json(std::string_view text) {
  std::uint64_t values = 0;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      i += c == '\\' ? 1 : 0;
      in_string = c != '"';
      continue;
    }
    in_string = c == '"';
    depth += c == '[' || c == '{' ? 1 : (c == ']' || c == '}' ? -1 : 0);
    values += c == '[' || c == '{' || c == ',' ? 1 : 0;
    fail_if(depth > kGltfDepthLimit || values > kGltfValueLimit, "the JSON has more than ", kGltfValueLimit,
            " values, or nests them deeper than ", kGltfDepthLimit, ", at its byte ", i);
  }
}

json parse_json(std::string_view text) {
  check_json(text);
  try {
    json parsed = json::parse(text.begin(), text.end());
    fail_if(!parsed.is_object(), "the JSON is no object");
    return parsed;
  } catch (const json::exception& error) {
    throw InputError(json_fault(error));
  }
}

/// Bytes that were written as letters, six bits each; nothing where there are others.
std::optional<std::string> decode_base64(std::string_view text) {
  std::string out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') {
      break;
    }
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+' || c == '-' ? 62
                      : c == '/' || c == '_' ? 63
                                             : -1;
    if (value < 0) {
      return std::nullopt;
    }
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      out.push_back(static_cast<char>(bits >> count));
    }
  }
  return out;
}

/// A link with %20 and the like written out.
std::string decode_percent(const std::string& uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const auto code = number_in<std::uint8_t>(std::string_view(uri).substr(i + 1, 2), 16);
    const bool is_coded = uri[i] == '%' && i + 2 < uri.size() && code;
    out.push_back(is_coded ? static_cast<char>(code.value_or(0)) : uri[i]);
    i += is_coded ? 2 : 0;
  }
  return out;
}

/// Where a link leads from the file's folder, without `..`; nothing where that is not below it.
std::optional<std::string> place_below(std::string_view link) {
  std::string place;
  bool is_below = !link.starts_with('/') && link.find("://") == std::string_view::npos &&
                  link.find('\0') == std::string_view::npos;
  while (is_below && !link.empty()) {
    const std::string_view part = link.substr(0, link.find('/'));
    link.remove_prefix(std::min(part.size() + 1, link.size()));
    if (part == "..") {
      is_below = !place.empty();
      place.resize(is_below ? place.rfind('/') : 0);
    } else if (!part.empty() && part != ".") {
      place.append("/").append(part);
    }
  }
  return is_below && !place.empty() ? std::optional(place.substr(1)) : std::nullopt;
}

}  // namespace

std::string json_fault(const json::exception& error) {
  const auto* const broken = dynamic_cast<const json::parse_error*>(&error);
  return broken != nullptr ? "the JSON is broken at its byte " + std::to_string(broken->byte)
                           : "the JSON holds a number or a text that cannot be read";
}

const json* gltf_member(const json& object, const char* name) {
  if (!object.is_object()) {
    return nullptr;
  }
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

const json* gltf_extension(const json& object, const char* name) {
  const json* extensions = gltf_member(object, "extensions");
  return extensions == nullptr ? nullptr : gltf_member(*extensions, name);
}

const json::array_t& gltf_list(const json& object, const char* name) {
  static const json::array_t kNone;
  const json* member = gltf_member(object, name);
  return member != nullptr && member->is_array() ? member->get_ref<const json::array_t&>() : kNone;
}

std::optional<std::uint64_t> gltf_number(const json& object, const char* name, const std::string& place) {
  const json* member = gltf_member(object, name);
  if (member == nullptr) {
    return std::nullopt;
  }
  if (member->is_number_unsigned()) {
    return member->get<std::uint64_t>();
  }
  // Exporters have written 12.0.
  const double value = member->is_number() ? member->get<double>() : -1;
  fail_if(!(value >= 0 && value <= 9007199254740992.0) || value != std::floor(value), place, ": ", name,
          " is no whole number from 0 on");
  return static_cast<std::uint64_t>(value);
}

void gltf_reals(const json& object, const char* name, std::span<double> values, const std::string& place) {
  const json* member = gltf_member(object, name);
  if (member == nullptr) {
    return;
  }
  bool is_good = member->is_array() && member->size() == values.size();
  for (std::size_t i = 0; is_good && i < values.size(); ++i) {
    is_good = (*member)[i].is_number();
    values[i] = is_good ? (*member)[i].get<double>() : 0;
  }
  fail_if(!is_good, place, ": ", name, " is no list of ", values.size(), " numbers");
}

void gltf_real(const json& object, const char* name, double& value, const std::string& place) {
  const json* member = gltf_member(object, name);
  if (member == nullptr) {
    return;
  }
  fail_if(!member->is_number(), place, ": ", name, " is no number");
  value = member->get<double>();
}

double GltfAccessor::real(std::uint64_t i, std::uint32_t component) const {
  const double value = load_number(&bytes[i * stride + component * type.size_bytes], type, false);
  if (!normalized || type.kind == 'f' || type.size_bytes == 4) {
    return value;
  }
  const int bits = static_cast<int>(8 * type.size_bytes) - (type.kind == 'i' ? 1 : 0);
  return std::fmax(value / ((1 << bits) - 1), -1);
}

std::uint32_t GltfAccessor::index(std::uint64_t i) const {
  return static_cast<std::uint32_t>(load_bits(&bytes[i * stride], type.size_bytes, false));
}

GltfFile::GltfFile(const SharedBytes& file, const std::string& path)
    : file_(file), path_(path), bytes_read_(file.bytes.size()) {
  fail_if(!looks_like_gltf(file.text()),
          "is no glTF file: it begins neither with \"glTF\" nor with a JSON object that names its asset");
  if (!file.text().starts_with("glTF")) {
    json_ = parse_json(file.text());
    const json* asset = gltf_member(json_, "asset");
    const json* version = asset == nullptr ? nullptr : gltf_member(*asset, "version");
    if (version != nullptr && version->is_string() &&
        !version->get_ref<const std::string&>().starts_with("2")) {
      throw InputError("version ", tools::quoted(version->get_ref<const std::string&>()),
                       " is not supported, only 2 is");
    }
    return;
  }
  ByteReader reader(file.bytes, "the header");
  reader.skip(4);
  const std::uint32_t version = reader.u32();
  fail_if(version != 2, "version ", version, " at byte offset 4 is not supported, only 2 is");
  reader.skip(4);
  bool has_json = false;
  while (reader.remaining() >= 8) {
    const std::uint32_t size = reader.u32();
    const std::uint32_t kind = reader.u32();
    ByteReader chunk = reader.sub(size, "the chunk at byte offset " + std::to_string(reader.offset() - 8));
    const SharedBytes content{chunk.take(size), file.owner};
    if (!has_json) {
      fail_if(kind != kJsonChunk, "the first chunk is not JSON");
      json_ = parse_json(content.text());
      has_json = true;
    } else if (kind == kBinaryChunk && !binary_) {
      binary_ = content;
    }
  }
  fail_if(!has_json, "the file ends before its JSON");
}

const json& GltfFile::entry(const char* name, std::uint64_t i) const {
  const json::array_t& list = gltf_list(json_, name);
  fail_if(i >= list.size(), "there is no entry ", i, " among the ", list.size(), " of '", name, "'");
  const json& found = list[static_cast<std::size_t>(i)];
  fail_if(!found.is_object(), "entry ", i, " of '", name, "' is no object");
  return found;
}

std::string GltfFile::link(const std::string& uri, const std::string& place, SharedBytes& bytes) {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos || uri.substr(0, comma).find(";base64") == std::string::npos) {
      return place + ": its data link is not base64";
    }
    std::optional<std::string> decoded = decode_base64(std::string_view(uri).substr(comma + 1));
    if (!decoded) {
      return place + ": its link holds something else than base64";
    }
    bytes = SharedBytes::own(std::move(*decoded));
    bytes_read_ += bytes.bytes.size();
    return {};
  }
  const std::optional<std::string> relative = place_below(decode_percent(uri));
  if (path_.empty() || !relative) {
    return place + ": its link " + tools::quoted(uri) + " is no file in the folder of this one";
  }
  const auto found = beside_.find(*relative);
  if (found != beside_.end()) {
    bytes = found->second;
    return {};
  }
  const std::string fault =
      load_beside(path_.substr(0, path_.rfind('/') + 1) + *relative, kFileLimitBytes, bytes);
  if (!fault.empty()) {
    return place + ": the file " + tools::quoted(uri) + " beside this one " + fault;
  }
  beside_.emplace(*relative, bytes);
  bytes_read_ += bytes.bytes.size();
  return {};
}

std::span<const std::uint8_t> GltfFile::buffer(std::uint64_t i) {
  const auto found = buffers_.find(i);
  if (found != buffers_.end()) {
    return found->second.bytes;
  }
  const std::string place = "buffer " + std::to_string(i);
  const json& entry = this->entry("buffers", i);
  const json* uri = gltf_member(entry, "uri");
  if (uri == nullptr) {
    fail_if(i != 0 || !binary_, place, ": it has no link, and the file has no binary chunk for it");
    return binary_->bytes;
  }
  fail_if(!uri->is_string(), place, ": its link is no text");
  SharedBytes bytes;
  const std::string fault = link(uri->get_ref<const std::string&>(), place, bytes);
  fail_if(!fault.empty(), fault);
  return buffers_.emplace(i, std::move(bytes)).first->second.bytes;
}

std::span<const std::uint8_t> GltfFile::buffer_view(std::uint64_t i) {
  const std::string place = "buffer view " + std::to_string(i);
  const json& view = entry("bufferViews", i);
  fail_if(gltf_extension(view, "EXT_meshopt_compression") != nullptr, place,
          ": its data is compressed (EXT_meshopt_compression), which is not read");
  const auto whole = buffer(gltf_number(view, "buffer", place).value_or(0));
  const std::uint64_t offset = gltf_number(view, "byteOffset", place).value_or(0);
  const std::uint64_t length = gltf_number(view, "byteLength", place).value_or(0);
  fail_if(offset > whole.size() || length > whole.size() - offset, place, ": ", length, " bytes from ",
          offset, " on are not in its buffer of ", whole.size());
  return whole.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

void GltfFile::lay(GltfAccessor& accessor, std::uint64_t view, std::uint64_t offset,
                   const std::string& place) {
  const std::uint64_t element = accessor.element_bytes();
  accessor.stride = gltf_number(entry("bufferViews", view), "byteStride", place).value_or(element);
  const auto bytes = buffer_view(view);
  const bool fits =
      offset <= bytes.size() && accessor.stride >= element && accessor.stride <= 65535 &&
      (accessor.count == 0 || (element <= bytes.size() - offset &&
                               accessor.count - 1 <= (bytes.size() - offset - element) / accessor.stride));
  fail_if(!fits, place, ": ", accessor.count, " times ", element, " bytes from ", offset, " on, one every ",
          accessor.stride, ", are not in its buffer view of ", bytes.size());
  accessor.bytes = bytes.subspan(static_cast<std::size_t>(offset));
}

std::span<const std::uint8_t> GltfFile::make(std::uint64_t i, const GltfAccessor& accessor,
                                             const json* sparse) {
  const auto known = made_.find(i);
  if (known != made_.end()) {
    return known->second;
  }
  const std::string place = "accessor " + std::to_string(i);
  const auto element = static_cast<std::size_t>(accessor.element_bytes());
  std::vector<std::uint8_t> bytes = room_for(accessor, place);
  const auto set = [&](std::uint64_t to, const GltfAccessor& from, std::uint64_t k) {
    std::copy_n(from.bytes.begin() + static_cast<std::ptrdiff_t>(k * from.stride), element,
                bytes.begin() + static_cast<std::ptrdiff_t>(to * element));
  };
  for (std::uint64_t k = 0; !accessor.bytes.empty() && k < accessor.count; ++k) {
    set(k, accessor, k);
  }
  if (sparse != nullptr) {
    const json* where = gltf_member(*sparse, "indices");
    const json* what = gltf_member(*sparse, "values");
    const auto index_view = where == nullptr ? std::nullopt : gltf_number(*where, "bufferView", place);
    const auto value_view = what == nullptr ? std::nullopt : gltf_number(*what, "bufferView", place);
    GltfAccessor indices;
    indices.components = 1;
    indices.count = gltf_number(*sparse, "count", place).value_or(0);
    indices.type = where == nullptr ? NumberType{'u', 0} : component_type_of(*where, place);
    fail_if(!index_view || !value_view || indices.type.kind != 'u' || indices.type.size_bytes == 0, place,
            ": its sparse values lack their indices or themselves");
    GltfAccessor values = accessor;
    values.count = indices.count;
    lay(indices, *index_view, gltf_number(*where, "byteOffset", place).value_or(0), place);
    lay(values, *value_view, gltf_number(*what, "byteOffset", place).value_or(0), place);
    for (std::uint64_t k = 0; k < indices.count; ++k) {
      const std::uint32_t index = indices.index(k);
      fail_if(index >= accessor.count, place, ": its sparse value ", k, " has the index ", index,
              ", which is not one of its ", accessor.count);
      set(index, values, k);
    }
  }
  return made_.emplace(i, std::move(bytes)).first->second;
}

std::vector<std::uint8_t> GltfFile::room_for(const GltfAccessor& accessor, const std::string& place) {
  const std::uint64_t element = accessor.element_bytes();
  fail_if(accessor.count > (most_bytes() - std::min(most_bytes(), bytes_made_)) / element, place, ": ",
          accessor.count, " sparse or compressed values take more than the limit of ", most_bytes(),
          " bytes, three times what the file holds and 64 MB");
  bytes_made_ += accessor.count * element;
  return std::vector<std::uint8_t>(static_cast<std::size_t>(accessor.count * element));
}

void GltfFile::fill(std::uint64_t i, std::uint64_t count,
                    const std::function<double(std::uint64_t, std::uint32_t)>& value) {
  if (made_.contains(i)) {
    return;
  }
  const std::string place = "accessor " + std::to_string(i);
  const GltfAccessor accessor = described(i, place);
  fail_if(accessor.count != count, place, ": it has ", accessor.count, " values, and its compressed data ",
          count);
  std::vector<std::uint8_t> bytes = room_for(accessor, place);
  std::size_t at = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    for (std::uint32_t component = 0; component < accessor.components; ++component) {
      const double number = value(k, component);
      std::uint64_t bits = 0;
      if (accessor.type.kind == 'f') {
        bits = std::bit_cast<std::uint32_t>(static_cast<float>(number));
      } else if (std::fabs(number) <= UINT32_MAX) {  // else it means nothing
        bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(number));
      }
      for (std::size_t byte = 0; byte < accessor.type.size_bytes; ++byte) {
        bytes[at++] = static_cast<std::uint8_t>(bits >> 8 * byte);
      }
    }
  }
  made_.emplace(i, std::move(bytes));
}

GltfAccessor GltfFile::described(std::uint64_t i, const std::string& place) const {
  const json& entry = this->entry("accessors", i);
  static constexpr std::array<std::pair<std::string_view, std::uint32_t>, 4> kShapes{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}}};
  GltfAccessor accessor;
  const json* type = gltf_member(entry, "type");
  for (const auto& [name, components] : kShapes) {
    if (type != nullptr && type->is_string() && type->get_ref<const std::string&>() == name) {
      accessor.components = components;
    }
  }
  accessor.type = component_type_of(entry, place);
  fail_if(accessor.element_bytes() == 0, place,
          ": its type or componentType is missing or none of numbers and vectors");
  const json* normalized = gltf_member(entry, "normalized");
  accessor.normalized = normalized != nullptr && normalized->is_boolean() && normalized->get<bool>();
  accessor.count = gltf_number(entry, "count", place).value_or(0);
  return accessor;
}

GltfAccessor GltfFile::accessor(std::uint64_t i) {
  const std::string place = "accessor " + std::to_string(i);
  const json& entry = this->entry("accessors", i);
  GltfAccessor accessor = described(i, place);
  const auto view = gltf_number(entry, "bufferView", place);
  const json* sparse = gltf_member(entry, "sparse");
  if (view) {
    lay(accessor, *view, gltf_number(entry, "byteOffset", place).value_or(0), place);
  }
  if (sparse != nullptr || !view) {  // without a view: zeros
    accessor.bytes = make(i, accessor, sparse);
    accessor.stride = accessor.element_bytes();
  }
  return accessor;
}

}  // namespace thimble::tools
