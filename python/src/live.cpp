#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <utility>

#include <nanobind/nanobind.h>
#include <nanobind/stl/unique_ptr.h>

#include <meshgraft/deform/live_deformer.h>
#include <meshgraft/mesh/normals.h>

#include "bindings.h"
#include "calls.h"
#include "deform.h"
#include "deform/facts.h"
#include "edits.h"
#include "errors.h"
#include "records.h"
#include "to_python.h"

namespace meshgraft::python {

namespace {

// Stands behind Python's LiveDeformer. The callbacks run on the library's threads; they take the GIL for as
// long as Python's function runs.
class LiveHolder {
 public:
  LiveHolder(std::shared_ptr<const Preparation> preparation, nb::object on_frame, nb::object on_failure,
             const LiveOptions& options, const Call& call)
      : preparation_(std::move(preparation)),
        on_frame_(std::move(on_frame)),
        on_failure_(std::move(on_failure)),
        delivers_(!on_frame_.is_none()),
        tells_(!on_failure_.is_none()),
        fork_depth_(fork_depth()) {
    LiveCallbacks callbacks;
    callbacks.frame = [this](const LiveFrame& frame) { take(frame); };
    callbacks.failed = [this](std::int64_t pose, const Error& error) { fail(pose, error); };
    live_ = std::make_unique<LiveDeformer>(preparation_->problem(), callbacks, options, context_of(call));
  }
  LiveHolder(const LiveHolder&) = delete;
  LiveHolder& operator=(const LiveHolder&) = delete;
  ~LiveHolder() {
    if (fork_depth_ != fork_depth()) {
      (void)live_.release();  // its threads are in another process
      return;
    }
    const nb::gil_scoped_release release;  // a callback may wait for the GIL
    live_.reset();
  }

  std::int64_t drag(const nb::sequence& poses) {
    require_here();
    return live_->drag(preparation_->poses_of(poses));
  }

  void wait(const nb::tuple& call) {
    require_here();
    if (calling_ == this) throw Error(facts::deform::WaitInCallback{});
    run(call_of(call), [&](const Context& context) {
      // `wait_until_exact` itself ends only with an exact frame, an error, or this.
      const std::stop_callback close_on_stop(context.stop_token, [this] { live_->close(); });
      live_->wait_until_exact();
    });
  }

  // Returns (pose, positions, accuracy, seconds, error) of the newest frame, or None.
  nb::object newest() {
    const std::lock_guard lock(mutex_);
    return newest_ ? frame_of(*newest_) : nb::object(nb::none());
  }

  nb::object stage() const { return to_python(live_ ? live_->stage() : LiveStage::closed); }
  std::int64_t superseded() const { return live_ ? live_->superseded() : 0; }
  void close() {
    if (live_ && fork_depth_ == fork_depth()) live_->close();
  }

  // Python's garbage collector asks for the functions that the object holds, because they may refer to it.
  int traverse(visitproc visit, void* arg) const {
    Py_VISIT(on_frame_.ptr());
    Py_VISIT(on_failure_.ptr());
    return 0;
  }
  void forget_callbacks() { on_frame_ = on_failure_ = nb::none(); }

  // Closes and waits for the threads, so that none of them calls Python when the interpreter ends.
  void finish() {
    if (fork_depth_ == fork_depth()) {
      const nb::gil_scoped_release release;
      live_.reset();
    }
    forget_callbacks();
  }

 private:
  void require_here() const {
    require_same_process(fork_depth_, "LiveDeformer");
    if (!live_) throw std::runtime_error("LiveDeformer: the interpreter is ending");
  }

  nb::object frame_of(const LiveFrame& frame) const {
    // The frame's own memory: nobody writes to it any more.
    const auto rows = static_cast<std::size_t>(frame.positions->rows());
    auto* kept = new std::shared_ptr<const Points>(frame.positions);
    nb::capsule owner(
        kept, [](void* pointer) noexcept { delete static_cast<std::shared_ptr<const Points>*>(pointer); });
    return nb::make_tuple(frame.pose, view_of((*kept)->data(), {rows, 3}, owner), to_python(frame.accuracy),
                          frame.seconds, to_python(frame.error_rel));
  }

  void take(const LiveFrame& frame) {
    LiveFrame own = frame;
    if (!preparation_->setup.weld.empty()) {
      auto positions = std::make_shared<Points>(*frame.positions);
      preparation_->spread({positions->data(), positions->rows(), 3});
      own.positions = positions;
    }
    {
      const std::lock_guard lock(mutex_);
      newest_ = own;
    }
    if (delivers_) call_python(on_frame_, [&](const nb::object& callback) { callback(frame_of(own)); });
  }

  void fail(std::int64_t pose, const Error& error) {
    if (tells_)
      call_python(on_failure_, [&](const nb::object& callback) { callback(pose, exception_of(error)); });
  }

  // Exceptions of the caller's function go to sys.unraisablehook: there is no call that could raise them.
  template <class Work>
  void call_python(const nb::object& callback, const Work& work) {
    const nb::gil_scoped_acquire acquire;
    const nb::object kept = callback;
    if (kept.is_none()) return;  // the object is being collected
    calling_ = this;
    try {
      work(kept);
    } catch (nb::python_error& error) {
      error.restore();
      PyErr_WriteUnraisable(kept.ptr());
    }
    calling_ = nullptr;
  }

  // The object whose callback runs on this thread. `wait` would wait for itself there.
  inline static thread_local const LiveHolder* calling_ = nullptr;
  std::shared_ptr<const Preparation> preparation_;
  nb::object on_frame_, on_failure_;
  bool delivers_, tells_;
  int fork_depth_;
  std::mutex mutex_;
  std::optional<LiveFrame> newest_;
  std::unique_ptr<LiveDeformer> live_;
};

std::unique_ptr<LiveHolder> make_live(const nb::tuple& given, const nb::object& on_frame,
                                      const nb::object& on_failure, const nb::dict& options,
                                      const nb::handle earlier, const nb::tuple& arguments) {
  const Call call = call_of(arguments);
  std::shared_ptr<const Preparation> preparation;
  const GivenEdit edit = edit_of_arguments(given);
  run(call, [&](const Context& context) { preparation = std::make_shared<const Preparation>(edit, context); });
  LiveOptions live;
  live.deformer = preparation->settings.deformer;
  live.proxy_from = nb::cast<Index>(options["proxy_from"]);
  live.proxy_vertices = nb::cast<Index>(options["proxy_vertices"]);
  live.settle_seconds = nb::cast<double>(options["settle_seconds"]);
  live.reduced.centres = nb::cast<Index>(options["centres"]);
  live.reduced.samples_per_centre = nb::cast<Index>(options["samples_per_centre"]);
  if (!earlier.is_none()) live.earlier = nb::cast<const DeformerHolder&>(earlier).deformer;
  return std::make_unique<LiveHolder>(std::move(preparation), on_frame, on_failure, live, call);
}

int traverse_live(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  return nb::inst_ready(self) ? nb::inst_ptr<LiveHolder>(self)->traverse(visit, arg) : 0;
}

int clear_live(PyObject* self) {
  nb::inst_ptr<LiveHolder>(self)->forget_callbacks();
  return 0;
}

PyType_Slot live_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(traverse_live)},
                            {Py_tp_clear, reinterpret_cast<void*>(clear_live)},
                            {0, nullptr}};

}  // namespace

void bind_live(nb::module_& module) {
  nb::class_<LiveHolder>(module, "LiveDeformer", nb::type_slots(live_slots))
      .def("drag", &LiveHolder::drag)
      .def("wait", &LiveHolder::wait)
      .def("newest", &LiveHolder::newest)
      .def("stage", &LiveHolder::stage)
      .def("superseded", &LiveHolder::superseded)
      .def("close", &LiveHolder::close)
      .def("finish", &LiveHolder::finish);
  module.def("make_live", &make_live, nb::arg(), nb::arg().none(), nb::arg().none(), nb::arg(),
             nb::arg().none(), nb::arg());
}

}  // namespace meshgraft::python
