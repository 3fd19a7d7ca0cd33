// Thumbnails of models, several at a time: server FOLDER FILE..., as a service would make them. Each becomes
// FOLDER/FILE.png; what cannot be read is said and passed over.
#include <atomic>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "thimble/files.h"

using namespace thimble;

namespace {
// The sentence that says what is wrong, or an empty one.
std::string make_thumbnail(const std::string& model, const std::string& picture) {
  try {
    const files::Scene scene(model);
    const auto bytes = files::png(scene.render(160, 120, {"--threads", "1"}));
    std::FILE* file = std::fopen(picture.c_str(), "wb");
    if (file == nullptr) return picture + " cannot be written";
    const bool is_written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    return std::fclose(file) == 0 && is_written ? "" : picture + " cannot be written";
  } catch (const std::exception& error) {  // files::Error, or no memory
    return model + ": " + error.what();
  }
}
}  // namespace

int main(int count, char** words) {
  if (count < 3) {
    std::fputs("usage: server FOLDER FILE...\n", stderr);
    return 1;
  }
  std::atomic<int> next{2}, failed{0};
  std::vector<std::jthread> pool;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
    pool.emplace_back([&] {
      for (int at = next++; at < count; at = next++) {
        const std::string model = words[at];
        const std::string name = model.substr(model.find_last_of('/') + 1);
        const std::string fault = make_thumbnail(model, std::string(words[1]) + "/" + name + ".png");
        std::fprintf(stderr, "%s\n", fault.empty() ? (name + ".png").c_str() : fault.c_str());
        failed += fault.empty() ? 0 : 1;
      }
    });
  }
  pool.clear();  // waits for all
  return failed == 0 ? 0 : 1;
}
