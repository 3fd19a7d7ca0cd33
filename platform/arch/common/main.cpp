// Compiled once an application: THIMBLE_APPLICATION is its name.
#include "apps/apps.h"

int thimble_application();

int thimble_application() {
  return thimble::apps::THIMBLE_APPLICATION();
}
