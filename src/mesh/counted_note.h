#pragma once

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A function that returns a note about a number of elements.
using CountedNote = Note (*)(Index count);

/// Returns the note of a class that has the field `count` alone.
template <class Class>
Note counted(Index count) {
  return Class{.count = count};
}

}  // namespace meshgraft
