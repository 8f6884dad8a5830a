#include <meshgraft/merge/merge_options.h>

#include <cstdint>

#include "ambiguous_start.h"
#include "merge/facts.h"

namespace meshgraft {

Fact ambiguous_start_fact(const std::vector<AmbiguousStart>& starts) {
  std::vector<std::size_t> pairs;
  std::vector<Index> targets, sources;
  std::vector<double> confidences;
  for (const AmbiguousStart& start : starts) {
    pairs.push_back(start.pair);
    targets.push_back(start.least_turned.target);
    sources.push_back(start.least_turned.source);
    confidences.push_back(start.confidence);
  }
  return facts::merge::AmbiguousStart{.confidence = confidences.front(),
                                      .target = targets.front(),
                                      .source = sources.front(),
                                      .pairs = pairs,
                                      .targets = targets,
                                      .sources = sources,
                                      .confidences = confidences};
}

std::vector<AmbiguousStart> ambiguous_starts(const Fact& fact) {
  using Integers = std::vector<std::int64_t>;
  const auto& pairs = fact.get<Integers>("pairs");
  const auto& targets = fact.get<Integers>("targets");
  const auto& sources = fact.get<Integers>("sources");
  const auto& confidences = fact.get<std::vector<double>>("confidences");
  std::vector<AmbiguousStart> starts;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    starts.push_back({static_cast<std::size_t>(pairs[k]),
                      {static_cast<Index>(sources[k]), static_cast<Index>(targets[k])},
                      confidences[k]});
  return starts;
}

}  // namespace meshgraft
