#include "handle.h"
#include "thimble/tree/edited_world.h"

namespace thimble::c_face {
namespace {

bool is_put(int32_t material) {
  return material >= EditedWorld::kEmpty && material <= 255;
}

}  // namespace

extern "C" size_t thimble_world_bytes(const thimble_tree_t* tree) {
  const CompactTree* const from = held<CompactTree>(tree);
  return from == nullptr ? 0 : EditedWorld::least_bytes(*from);
}

extern "C" int32_t thimble_world_make(thimble_world_t* world, const thimble_tree_t* tree, void* bytes,
                                      size_t size_bytes) {
  const CompactTree* const from = held<CompactTree>(tree);
  Bytes room;
  if (from == nullptr || !stands(world) || !take_bytes(bytes, size_bytes, &room)) {
    return number(Status::kBadArgument);
  }
  EditedWorld made;
  const EditRoom most = EditedWorld::room_in(*from, size_bytes);
  const Status status = EditedWorld::make(*from, most, room, &made);
  return hold(status, made, world);
}

extern "C" int32_t thimble_world_tree(const thimble_world_t* world, thimble_tree_t* tree) {
  const EditedWorld* const from = held<EditedWorld>(world);
  return from == nullptr || !stands(tree) ? number(Status::kBadArgument)
                                          : hold(Status::kOk, from->tree(), tree);
}

extern "C" int32_t thimble_world_bricks(const thimble_world_t* world, thimble_bricks_t* bricks) {
  const EditedWorld* const from = held<EditedWorld>(world);
  return from == nullptr || !stands(bricks) ? number(Status::kBadArgument)
                                            : hold(Status::kOk, from->map(), bricks);
}

extern "C" int32_t thimble_world_put(thimble_world_t* world, int32_t x, int32_t y, int32_t z,
                                     int32_t material) {
  return with<EditedWorld>(world, [=](EditedWorld& to) {
    return !is_put(material)                 ? Status::kOutOfRange
           : material == EditedWorld::kEmpty ? to.clear({x, y, z})
                                             : to.set({x, y, z}, static_cast<uint8_t>(material));
  });
}

extern "C" int32_t thimble_world_material(const thimble_world_t* world, int32_t x, int32_t y, int32_t z) {
  const EditedWorld* const from = held<EditedWorld>(world);
  return from == nullptr ? EditedWorld::kEmpty : from->material({x, y, z});
}

extern "C" int32_t thimble_journal_make(thimble_journal_t* journal, void* bytes, size_t size_bytes) {
  return make_held<EditJournal>(journal, bytes, size_bytes, [](Bytes entries, EditJournal* made) {
    *made = EditJournal(entries);
    return Status::kOk;
  });
}

extern "C" int32_t thimble_world_edit(thimble_world_t* world, thimble_journal_t* journal,
                                      const thimble_box_t* box, int32_t shape, int32_t material) {
  EditJournal* const noted = held<EditJournal>(journal);
  if (noted == nullptr || box == nullptr || (shape != THIMBLE_EDIT_BOX && shape != THIMBLE_EDIT_BALL)) {
    return number(Status::kBadArgument);
  }
  return with<EditedWorld>(world, [=](EditedWorld& to) {
    return is_put(material) ? to.edit({vector_of(box->low), vector_of(box->high)},
                                      static_cast<EditShape>(shape), material, noted)
                            : Status::kOutOfRange;
  });
}

extern "C" int32_t thimble_world_undo(thimble_world_t* world, thimble_journal_t* journal) {
  EditJournal* const noted = held<EditJournal>(journal);
  return noted == nullptr ? number(Status::kBadArgument)
                          : with<EditedWorld>(world, [=](EditedWorld& to) { return to.undo(noted); });
}

extern "C" int32_t thimble_world_pack(const thimble_world_t* world, void* bytes, size_t size_bytes,
                                      size_t* size_written) {
  const EditedWorld* const from = held<EditedWorld>(world);
  Bytes out;
  return from == nullptr || !take_bytes(bytes, size_bytes, &out) ? number(Status::kBadArgument)
                                                                 : number(from->pack(out, size_written));
}

}  // namespace thimble::c_face
