// Compiled once an application: THIMBLE_APPLICATION is its name.
namespace thimble::apps {

int THIMBLE_APPLICATION();

}  // namespace thimble::apps

int thimble_application();

int thimble_application() {
  return thimble::apps::THIMBLE_APPLICATION();
}
