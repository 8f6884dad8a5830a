#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace meshgraft::cli {

/// Writes the options of a command's help: `--up X Y Z`, `--as-morph-target [NAME]`, `MESH...`.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_usage(const CLI::Option* option) const override;
};

}  // namespace meshgraft::cli
