#include "readers/gltf_file.h"

#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <algorithm>

#include "readers/text.h"

namespace thimble::tools {
namespace {

using nlohmann::json;

/// Refuses what claims more triangles than so many bytes are believed to hold, since the decoder takes some hundred
/// bytes for each before it reads them. @throws InputError  that; or another version
void check_beginning(std::span<const std::uint8_t> packed, const std::string& place) {
  constexpr std::uint64_t kBelieved = 2'000'000;
  constexpr std::uint64_t kBelievedPerByte = 4;  // the least compressed meshes of use take half a byte each
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  draco::DracoHeader header{};
  bool is_good = buffer.Decode(header.draco_string, sizeof header.draco_string) &&
                 buffer.Decode(&header.version_major) && buffer.Decode(&header.version_minor) &&
                 buffer.Decode(&header.encoder_type) && buffer.Decode(&header.encoder_method) &&
                 buffer.Decode(&header.flags);
  fail_if(is_good && (header.version_major != draco::kDracoMeshBitstreamVersionMajor ||
                      header.version_minor != draco::kDracoMeshBitstreamVersionMinor),
          place, ": its Draco data is of version ", header.version_major, ".", header.version_minor,
          "; only 2.2 is read");
  if (is_good && (header.flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    is_good = draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata);
  }
  std::uint8_t traversal = 0;
  std::uint32_t points = 0;
  std::uint32_t faces = 0;
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING) {
    is_good = is_good && buffer.Decode(&traversal) && draco::DecodeVarint(&points, &buffer) &&
              draco::DecodeVarint(&faces, &buffer);
  } else {
    is_good = is_good && draco::DecodeVarint(&faces, &buffer) && draco::DecodeVarint(&points, &buffer);
  }
  fail_if(!is_good, place, ": its Draco data is damaged at its beginning");
  fail_if(std::max(points, faces) > kBelieved + kBelievedPerByte * packed.size(), place,
          ": its Draco data claims ", faces, " triangles and ", points, " points in ", packed.size(),
          " bytes");
}

}  // namespace

void unpack_draco(GltfFile& file, const json& primitive, const json& extension, const std::string& place) {
  const auto view = gltf_number(extension, "bufferView", place);
  const auto indices = gltf_number(primitive, "indices", place);
  const json* ids = gltf_member(extension, "attributes");
  const json* attributes = gltf_member(primitive, "attributes");
  fail_if(!view || !indices || ids == nullptr || !ids->is_object(), place,
          ": its KHR_draco_mesh_compression lacks bufferView or attributes, or it has no indices");
  const auto packed = file.buffer_view(*view);
  check_beginning(packed, place);
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  fail_if(!decoded.ok(), place, ": its Draco data is damaged");
  const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
  file.unpacked(*view, std::uint64_t{mesh->num_faces()} * 12 + std::uint64_t{mesh->num_points()} * 12);
  file.fill(*indices, std::uint64_t{mesh->num_faces()} * 3,
            [&](std::uint64_t k, std::uint32_t /*component*/) {
              return static_cast<double>(
                  mesh->face(draco::FaceIndex(static_cast<std::uint32_t>(k / 3)))[k % 3].value());
            });
  for (const auto& [name, id] : ids->items()) {
    const auto accessor = gltf_number(*attributes, name.c_str(), place);
    const auto unique_id = gltf_number(*ids, name.c_str(), place);
    const draco::PointAttribute* const attribute =
        unique_id && *unique_id <= UINT32_MAX
            ? mesh->GetAttributeByUniqueId(static_cast<std::uint32_t>(*unique_id))
            : nullptr;
    fail_if(!accessor || attribute == nullptr, place, ": its Draco data has no ", tools::quoted(name),
            " as it says");
    std::array<float, 4> reals{};
    std::array<std::int64_t, 4> integers{};
    const bool is_real = attribute->data_type() == draco::DT_FLOAT32;
    file.fill(*accessor, mesh->num_points(), [&](std::uint64_t k, std::uint32_t component) {
      if (component == 0) {
        const auto value = attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(k)));
        const bool has_value = is_real ? attribute->ConvertValue<float>(value, 4, reals.data())
                                       : attribute->ConvertValue<std::int64_t>(value, 4, integers.data());
        fail_if(!has_value, place, ": its Draco data has values of a kind that is not read");
      }
      return is_real ? static_cast<double>(reals[component]) : static_cast<double>(integers[component]);
    });
  }
}

}  // namespace thimble::tools
