# What people type. Each target installs what it lacks (tools/bootstrap.sh), builds, and does its job; the
# build itself is CMake's (CMakePresets.json).

ifneq ($(shell command -v ccache),)
export CMAKE_C_COMPILER_LAUNCHER ?= ccache
export CMAKE_CXX_COMPILER_LAUNCHER ?= ccache
# Clones in other places share what was compiled.
export CCACHE_BASEDIR ?= $(CURDIR)
export CCACHE_NOHASHDIR ?= 1
endif

PREFIX ?= /usr/local
BENCH_ARGS ?=
FUZZ_SECONDS ?= 60
FACT_TABLES := $(sort $(wildcard src/*/facts.json src/io/*/facts.json)) cli/facts.json python/facts.json

.DEFAULT_GOAL := help
.PHONY: help demo edit test test-long build install wheel lint format bench bench-page asan tsan fuzz docs-pictures facts clean

help: ## this list
	@echo "meshgraft $$(cat VERSION): make TARGET"
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  %-14s %s\n", $$1, $$2}' $(firstword $(MAKEFILE_LIST))

demo: build ## run the examples; meshes, reports and pictures go to out/
	@tools/demo.sh

edit: build ## the editor in the browser: make edit MODEL=model.ply, or without a model
	@build/release/meshgraft edit $(MODEL)

test: ## the tests: with and without the optional libraries, page, layers, installed package
	@MESHGRAFT_VENV=none tools/bootstrap.sh build test
	@python3 tools/run_tests.py minimal release

test-long: ## what make test leaves out: sanitizers, large meshes, slow work
	@tools/bootstrap.sh build test
	@python3 tools/run_tests.py asan tsan; sanitized=$$?; cmake --preset release -DMESHGRAFT_BUILD_TESTS=ON && \
	  cmake --build --preset release && ctest --preset long && exit $$sanitized

build: ## the program: build/release/meshgraft
	@tools/bootstrap.sh build
	@tools/build.sh

install: build ## library and program to PREFIX (/usr/local)
	@cmake --build --preset release
	@cmake --install build/release --prefix $(PREFIX)

wheel: ## a wheel of the Python package, with the program, to dist/; PYTHON=python3.12: for another interpreter
	@tools/bootstrap.sh build test
	@build/venv/bin/python tools/make_wheel.py $(if $(PYTHON),--python $(PYTHON))

lint: ## code style and static analysis
	@tools/bootstrap.sh build test lint
	@tools/lint.sh

format: ## bring the code into style
	@tools/bootstrap.sh lint
	@tools/lint.sh --fix-format

bench: ## benchmarks, beside CGAL; all: into docs/performance.md; BENCH_ARGS='--benchmark_filter=…': to the terminal
	@tools/bootstrap.sh build bench
	@cmake --preset bench && cmake --build --preset bench --target meshgraft_bench
	@mkdir -p out && build/bench/bench/meshgraft_bench --benchmark_out=out/bench.json $(BENCH_ARGS)
	@bench/report.py out/bench.json $(if $(BENCH_ARGS),,--into docs/performance.md)

bench-page: build ## latency of the editor in the browser, as a Markdown table; SIZE=1000000: of one size alone
	@tools/bootstrap.sh build test
	@cd page && node_modules/.bin/vite-node bench/latency.ts $(SIZE)

asan: ## the small tests under address and undefined-behaviour sanitizers
	@tools/bootstrap.sh build test
	@python3 tools/run_tests.py asan

tsan: ## the threaded tests under the thread sanitizer
	@tools/bootstrap.sh build test
	@python3 tools/run_tests.py tsan

fuzz: ## the fuzz targets, two at a time, FUZZ_SECONDS each
	@tools/bootstrap.sh build fuzz
	@cmake --preset fuzz && cmake --build --preset fuzz
	@tools/fuzz.sh $(FUZZ_SECONDS)

facts: ## docs/facts.md from the tables of facts
	@python3 tools/facts.py list $(FACT_TABLES) > docs/facts.md

docs-pictures: build ## make the pictures of README and docs again
	@tools/bootstrap.sh docs
	@tools/docs_pictures.sh

clean: ## remove build/, dist/ and out/
	@rm -rf build dist out
