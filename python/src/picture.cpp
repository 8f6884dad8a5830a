#include <array>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <meshgraft/core/error.h>
#include <meshgraft/samples/samples.h>

#include "arrays.h"
#include "bindings.h"
#include "calls.h"
#include "mesh.h"
#include "mesh/up_axis.h"
#include "python/facts.h"
#include "records.h"
#include "to_python.h"

#ifdef MESHGRAFT_HAS_RENDER
#include "render/render.h"
#include "render/viewpoint.h"
#endif

namespace meshgraft::python {

namespace {

#ifdef MESHGRAFT_HAS_RENDER

nb::object array_of_image(render::Image image) {
  const std::array<std::size_t, 3> shape{static_cast<std::size_t>(image.height),
                                         static_cast<std::size_t>(image.width), 3};
  return array_over(std::move(image.pixels), shape);
}

render::Image image_of(const nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 3>, nb::c_contig>& array) {
  return {static_cast<int>(array.shape(1)),
          static_cast<int>(array.shape(0)),
          {array.data(), array.data() + array.size()}};
}

render::RenderOptions render_options_of(const nb::dict& options) {
  render::RenderOptions render;
  render.width = nb::cast<int>(options["width"]);
  render.height = nb::cast<int>(options["height"]);
  render.samples = nb::cast<int>(options["samples"]);
  render.occlusion_rays = nb::cast<int>(options["occlusion_rays"]);
  render.smooth = nb::cast<bool>(options["smooth"]);
  render.crease_angle_deg = nb::cast<double>(options["crease_angle_deg"]);
  render.wireframe = nb::cast<bool>(options["wireframe"]);
  render.ground = nb::cast<bool>(options["ground"]);
  render.camera.field_of_view_deg = nb::cast<double>(options["field_of_view_deg"]);
  const auto vector = [&](const char* name) {
    const auto array = nb::cast<NumbersIn>(options[name]);
    return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(array.data()));
  };
  render.camera.up = vector("up");
  render.camera.from_direction =
      options["look_from"].is_none() ? render::usual_direction(render.camera.up) : vector("look_from");
  if (!options["low"].is_none()) {
    render.camera.low = vector("low");
    render.camera.high = vector("high");
  }
  return render;
}

// Draws one picture of some meshes in place. `colours` has an n×3 array per mesh, or None for the mesh's own.
nb::object draw(const std::vector<nb::object>& meshes, const std::vector<nb::object>& colours,
                const nb::dict& options, const nb::tuple& call) {
  const render::RenderOptions render = render_options_of(options);
  std::vector<std::shared_ptr<const Mesh>> kept;
  std::vector<Points> given;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    kept.push_back(nb::cast<const MeshHolder&>(meshes[k]).mesh);
    given.push_back(colours[k].is_none() ? render::vertex_colours(*kept[k])
                                         : points_of(nb::cast<PointsIn>(colours[k])));
  }
  return array_of_image(run_for(call_of(call), [&](const Context& context) {
    std::vector<render::Shape> shapes;
    for (std::size_t k = 0; k < kept.size(); ++k) shapes.push_back({kept[k].get(), given[k]});
    return render::render(shapes, render, context);
  }));
}

void bind_drawing(nb::module_& module) {
  module.def("draw", &draw);
  module.def("png_bytes", [](const nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 3>, nb::c_contig>& array) {
    const std::vector<std::uint8_t> bytes = render::png_bytes(image_of(array));
    return nb::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  });
  module.def(
      "side_by_side", [](const std::vector<nb::object>& pictures, const std::vector<std::string>& captions) {
        std::vector<render::Image> images;
        for (const nb::object& picture : pictures)
          images.push_back(
              image_of(nb::cast<nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 3>, nb::c_contig>>(picture)));
        return array_of_image(render::side_by_side(images, captions));
      });
}

#else

[[noreturn]] void fail() { throw Error(facts::python::NoRenderer{}); }

void bind_drawing(nb::module_& module) {
  for (const char* name : {"draw", "png_bytes", "side_by_side"})
    module.def(name, [](const nb::args&) { fail(); });
}

#endif

}  // namespace

void bind_picture(nb::module_& module) {
  bind_drawing(module);
  module.def("up_axis",
             [](const MeshHolder& holder) { return up_axis_of(*holder.mesh) == UpAxis::y ? "y" : "z"; });
  module.def("sample", [](const std::string& name, int resolution, const nb::tuple& call) {
    return to_python(
        run_for(call_of(call), [&](const Context& context) { return make_sample(name, resolution, context); }));
  });
  module.def("samples", [] {
    nb::list list;
    for (const SampleInfo& info : sample_list()) list.append(to_python(info));
    return nb::tuple(list);
  });
}

}  // namespace meshgraft::python
