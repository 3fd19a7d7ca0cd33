/// The JSON of a glTF file and the bytes that it talks of. Internal to the glTF reader.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "readers/file_bytes.h"

namespace thimble::tools {

/// Numbers in a buffer: vectors of 1 to 16 components.
struct GltfAccessor {
  std::span<const std::uint8_t> bytes;  ///< from the first component on
  std::uint64_t stride = 0;
  std::uint64_t count = 0;
  NumberType type;
  std::uint32_t components = 0;
  bool normalized = false;

  /// Of one vector; 0 where the type is none.
  std::uint64_t element_bytes() const { return components * type.size_bytes; }
  /// A component as a number; normalised integers become 0 to 1 or -1 to 1.
  double real(std::uint64_t i, std::uint32_t component) const;
  /// A component of an unsigned type.
  std::uint32_t index(std::uint64_t i) const;
};

/// The member `name` of `object` as a whole number; nothing where there is none.
std::optional<std::uint64_t> gltf_number(const nlohmann::json& object, const char* name,
                                         const std::string& place);
/// As reals; `values` stays as it is where there is no such member. @throws InputError  not that many numbers
void gltf_reals(const nlohmann::json& object, const char* name, std::span<double> values,
                const std::string& place);
/// One of them.
void gltf_real(const nlohmann::json& object, const char* name, double& value, const std::string& place);
/// The member `name`, or null.
const nlohmann::json* gltf_member(const nlohmann::json& object, const char* name);
/// The extension `name` of `object`, or null.
const nlohmann::json* gltf_extension(const nlohmann::json& object, const char* name);
/// What the list `name` holds; nothing where there is none.
const nlohmann::json::array_t& gltf_list(const nlohmann::json& object, const char* name);

/// The sentence of what the JSON library throws. The page has it where it cannot catch (tools/web/runtime.cpp).
std::string json_fault(const nlohmann::json::exception& error);

/// Every member function throws an InputError that names the place: "accessor 3: ...".
class GltfFile {
 public:
  GltfFile(const SharedBytes& file, const std::string& path);

  const nlohmann::json& root() const { return json_; }
  /// Entry `i` of the list `name` ("meshes"), which is an object.
  const nlohmann::json& entry(const char* name, std::uint64_t i) const;
  /// How many entries it has.
  std::uint64_t count(const char* name) const { return gltf_list(json_, name).size(); }

  GltfAccessor accessor(std::uint64_t i);
  /// That of the member `name` of `object`; without it one of no components.
  GltfAccessor accessor(const nlohmann::json& object, const char* name, const std::string& place) {
    const auto number = gltf_number(object, name, place);
    return number ? accessor(*number) : GltfAccessor{};
  }
  std::span<const std::uint8_t> buffer_view(std::uint64_t i);
  /// Takes the bytes behind a link: `data:` or a file beside this one, which is read once however often it is named.
  /// @return what is wrong with it, or nothing
  std::string link(const std::string& uri, const std::string& place, SharedBytes& bytes);
  /// Gives accessor `i`, which has no bytes in the file, its values, `value(vector, component)`, in the type that it
  /// names. Whoever was filled stays as it is.
  /// @throws InputError  it has another count, or all values made take more than `most_bytes`
  void fill(std::uint64_t i, std::uint64_t count,
            const std::function<double(std::uint64_t, std::uint32_t)>& value);
  /// A buffer view turned out to hold so many bytes, unpacked; counted once.
  void unpacked(std::uint64_t view, std::uint64_t bytes) {
    bytes_read_ += unpacked_.insert(view).second ? bytes : 0;
  }
  /// What accessors take that no buffer holds as they are: sparse and unpacked ones.
  std::uint64_t bytes_made() const { return bytes_made_; }
  /// What all that is made of the file may take: three times what was read, and 64 MB.
  std::uint64_t most_bytes() const { return 3 * bytes_read_ + (std::uint64_t{64} << 20); }

 private:
  std::span<const std::uint8_t> buffer(std::uint64_t i);
  /// An accessor without its bytes.
  GltfAccessor described(std::uint64_t i, const std::string& place) const;
  /// Sets stride and bytes of `accessor` to those of a view from `offset` on.
  void lay(GltfAccessor& accessor, std::uint64_t view, std::uint64_t offset, const std::string& place);
  /// Room for the values of an accessor. @throws InputError  there is none
  std::vector<std::uint8_t> room_for(const GltfAccessor& accessor, const std::string& place);
  /// The values of a sparse accessor written out; `accessor` is laid on those that it changes, or on nothing.
  std::span<const std::uint8_t> make(std::uint64_t i, const GltfAccessor& accessor,
                                     const nlohmann::json* sparse);

  SharedBytes file_;
  std::string path_;
  nlohmann::json json_;
  std::optional<SharedBytes> binary_;  ///< of a .glb
  std::map<std::uint64_t, SharedBytes> buffers_;
  std::map<std::string, SharedBytes> beside_;                ///< by name
  std::map<std::uint64_t, std::vector<std::uint8_t>> made_;  ///< by accessor
  std::set<std::uint64_t> unpacked_;                         ///< buffer views
  std::uint64_t bytes_read_ = 0, bytes_made_ = 0;
};

/// Fills the accessors of `primitive` with what its `extension` (KHR_draco_mesh_compression) holds; then it is one of
/// triangles.
/// @throws InputError  damaged data, more triangles than its bytes are believed to hold, an accessor of another length
void unpack_draco(GltfFile& file, const nlohmann::json& primitive, const nlohmann::json& extension,
                  const std::string& place);

}  // namespace thimble::tools
