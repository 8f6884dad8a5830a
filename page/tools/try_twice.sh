#!/usr/bin/env bash
# Runs a command, and once more if it fails, and says so: a browser on a busy machine may miss a moment.
"$@" || { echo "once more: $*"; "$@"; }
