#include "progress_text.h"

#include <string_view>

namespace meshgraft::cli {

namespace {

struct StageWords {
  std::string_view stage, words;
};

// Words for stages. The identifiers of all other stages are words already.
constexpr StageWords stage_words[] = {
    {"find_surface", "finding the surface"},
    {"render", "rendering"},
    {"shape_triangles", "shaping triangles"},
};

std::string_view words_of_stage(std::string_view stage) {
  for (const StageWords& one : stage_words)
    if (one.stage == stage) return one.words;
  return stage;
}

}  // namespace

std::string progress_text(const Progress& progress) {
  std::string text(progress.within);
  if (progress.count > 0)
    text += " (" + std::to_string(progress.number) + " of " + std::to_string(progress.count) + ")";
  if (!text.empty()) text += ": ";
  return text += words_of_stage(progress.stage);
}

}  // namespace meshgraft::cli
