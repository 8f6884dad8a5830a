#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

#include "open_hole.h"

namespace meshgraft {

/// A target with a hole for each loop on which a source stands.
struct OpenedHoles {
  Mesh target;
  IndexMap vertex;               ///< vertices of the given target → `target`; -1 within a hole
  std::vector<MergePair> pairs;  ///< a loop of the source and the hole that it meets
  double size = 1;               ///< scale of the source
  bool clear = true;             ///< as of `OpenedHole`; set for a source on several feet, which is not checked
  std::vector<Note> notes;
};

/// Replaces the new indices of a map by those that a further change gives them.
void compose(IndexMap& map, const IndexMap& next);

/// Opens a hole for each of a source's loops. One loop goes where `open_hole` puts it. A source with several
/// loops is placed by their convex hull, undeformed. Then each loop gets a hole around the point of the surface
/// that is nearest to its centre. Without a given size, up to ten smaller ones are tried.
///
/// Throws what `open_hole` throws.
OpenedHoles open_holes(const Mesh& target, const Mesh& source, const std::vector<std::vector<Index>>& loops,
                       const Drop& drop, const Context& context = {});

}  // namespace meshgraft
