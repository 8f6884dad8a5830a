#include "model.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include <Model/COM/NMR_DLLInterfaces.h>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>
#include <meshgraft/mesh/mesh.h>

#include "core/facts.h"
#include "core/sparse_checks.h"
#include "mesh/edge_table.h"
#include "threemf/facts.h"

namespace meshgraft::io {

namespace {

constexpr std::array<std::string_view, 6> units = {"micron", "millimeter", "centimeter",
                                                   "inch",   "foot",       "meter"};

constexpr unsigned triangles_per_check = 1024;  // each takes several calls of lib3mf

/// Owns a reference to one of lib3mf's objects.
template <class T>
class Handle {
 public:
  Handle() = default;
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Handle() {
    if (object_ != nullptr) NMR::lib3mf_release(object_);
  }

  T* get() const { return object_; }
  T** receive() { return &object_; }

 private:
  T* object_ = nullptr;
};

/// Calls lib3mf on one model. A status other than success becomes an Error.
class Session {
 public:
  explicit Session(const Context& context) : context_(context) {
    if (NMR::lib3mf_createmodel(model_.receive()) != LIB3MF_OK)
      throw Error(facts::core::Bug{.what = "lib3mf cannot make a model"});
  }

  NMR::PLib3MFModel* model() const { return model_.get(); }
  const Context& context() const { return context_; }

  /// Throws if `status` is an error. `subject` is the object of the call, and it remembers the reason.
  void require(HRESULT status, NMR::PLib3MFBase* subject) const {
    if (status == LIB3MF_OK) return;
    context_.throw_if_stopped();
    DWORD code = 0;
    LPCSTR message = nullptr;
    NMR::lib3mf_getlasterror(subject, &code, &message);
    throw Error(facts::threemf::ModelRefused{.reason = message != nullptr ? message : "no reason"});
  }

  /// A progress callback for lib3mf. Returning false asks lib3mf to stop.
  static bool go_on(int, NMR::ProgressIdentifier, void* context) {
    return !is_stop_requested(*static_cast<const Context*>(context));
  }

 private:
  Handle<NMR::PLib3MFModel> model_;
  const Context& context_;
};

template <class Get>
std::string text_of(const Get& get) {
  ULONG size = 0;
  if (get(nullptr, 0, &size) != LIB3MF_OK || size == 0) return {};
  std::string text(size + 1, '\0');
  if (get(text.data(), size + 1, &size) != LIB3MF_OK) return {};
  text.resize(std::char_traits<char>::length(text.c_str()));
  return text;
}

Eigen::Affine3d affine(const NMR::MODELTRANSFORM& transform) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) result(row, column) = transform.m_fFields[row][column];
  return result;
}

/// Reads a model: the mesh objects, then their placements in the build.
class Reader {
 public:
  explicit Reader(const Context& context) : session_(context) {}

  ThreemfModel read(std::string_view package) {
    parse(package);
    read_unit();
    read_objects();
    read_build();
    return std::move(model_);
  }

 private:
  void parse(std::string_view package) {
    Handle<NMR::PLib3MFModelReader> reader;
    session_.require(NMR::lib3mf_model_queryreader(session_.model(), "3mf", reader.receive()),
                     session_.model());
    NMR::lib3mf_reader_setprogresscallback(reader.get(), &Session::go_on,
                                           const_cast<Context*>(&session_.context()));
    // lib3mf takes the bytes by a non-const pointer, but does not change them.
    auto* bytes = reinterpret_cast<BYTE*>(const_cast<char*>(package.data()));
    session_.require(NMR::lib3mf_reader_readfrombuffer(reader.get(), bytes, package.size()), reader.get());
  }

  void read_unit() {
    DWORD unit = 0;
    session_.require(NMR::lib3mf_model_getunit(session_.model(), &unit), session_.model());
    if (unit < units.size()) model_.unit = units[unit];
  }

  void read_objects() {
    Handle<NMR::PLib3MFModelResourceIterator> iterator;
    session_.require(NMR::lib3mf_model_getmeshobjects(session_.model(), iterator.receive()), session_.model());
    for (BOOL more = 0; NMR::lib3mf_resourceiterator_movenext(iterator.get(), &more) == LIB3MF_OK && more;) {
      session_.context().throw_if_stopped();
      Handle<NMR::PLib3MFModelResource> resource;
      session_.require(NMR::lib3mf_resourceiterator_getcurrent(iterator.get(), resource.receive()),
                       iterator.get());
      object_of_[id_of(resource.get())] = model_.objects.size();
      model_.objects.push_back(read_object(static_cast<NMR::PLib3MFModelMeshObject*>(resource.get())));
    }
  }

  DWORD id_of(NMR::PLib3MFModelResource* resource) const {
    DWORD id = 0;
    session_.require(NMR::lib3mf_resource_getresourceid(resource, &id), resource);
    return id;
  }

  ThreemfModel::Object read_object(NMR::PLib3MFModelMeshObject* mesh) {
    ThreemfModel::Object object;
    object.name = text_of([&](char* text, ULONG size, ULONG* needed) {
      return NMR::lib3mf_object_getnameutf8(mesh, text, size, needed);
    });
    DWORD vertices = 0, triangles = 0;
    session_.require(NMR::lib3mf_meshobject_getvertexcount(mesh, &vertices), mesh);
    session_.require(NMR::lib3mf_meshobject_gettrianglecount(mesh, &triangles), mesh);
    object.vertices.resize(vertices);
    object.triangles.resize(triangles);
    static_assert(sizeof(NMR::MODELMESHVERTEX) == sizeof object.vertices[0]);
    static_assert(sizeof(NMR::MODELMESHTRIANGLE) == sizeof object.triangles[0]);
    if (vertices > 0)
      session_.require(
          NMR::lib3mf_meshobject_getvertices(
              mesh, reinterpret_cast<NMR::MODELMESHVERTEX*>(object.vertices.data()), vertices, nullptr),
          mesh);
    if (triangles > 0)
      session_.require(
          NMR::lib3mf_meshobject_gettriangleindices(
              mesh, reinterpret_cast<NMR::MODELMESHTRIANGLE*>(object.triangles.data()), triangles, nullptr),
          mesh);
    read_properties(mesh, object);
    return object;
  }

  void read_properties(NMR::PLib3MFModelMeshObject* mesh, ThreemfModel::Object& object) {
    Handle<NMR::PLib3MFPropertyHandler> properties;
    Handle<NMR::PLib3MFDefaultPropertyHandler> fallback;
    session_.require(NMR::lib3mf_meshobject_createpropertyhandler(mesh, properties.receive()), mesh);
    session_.require(NMR::lib3mf_object_createdefaultpropertyhandler(mesh, fallback.receive()), mesh);
    const auto count = static_cast<DWORD>(object.triangles.size());
    SparseChecks check(session_.context(), triangles_per_check);
    for (DWORD t = 0; t < count; ++t) {
      check();
      NMR::eModelPropertyType type{};
      if (NMR::lib3mf_propertyhandler_getpropertytype(properties.get(), t, &type) != LIB3MF_OK) return;
      if (type == NMR::MODELPROPERTYTYPE_BASEMATERIALS) {
        DWORD group = 0, index = 0;
        if (NMR::lib3mf_propertyhandler_getbasematerial(properties.get(), t, &group, &index) == LIB3MF_OK)
          set_material(object, t, material(group, index));
      } else if (type == NMR::MODELPROPERTYTYPE_COLOR) {
        NMR::MODELMESH_TRIANGLECOLOR_SRGB colour{};
        if (NMR::lib3mf_propertyhandler_getcolor(properties.get(), t, &colour) == LIB3MF_OK)
          set_colour(object, t, colour);
      } else if (type == NMR::MODELPROPERTYTYPE_NONE) {
        set_default(fallback.get(), object, t);
      }
    }
  }

  void set_default(NMR::PLib3MFDefaultPropertyHandler* fallback, ThreemfModel::Object& object, DWORD t) {
    NMR::eModelPropertyType type{};
    if (NMR::lib3mf_defaultpropertyhandler_getpropertytype(fallback, &type) != LIB3MF_OK) return;
    DWORD group = 0, index = 0;
    NMR::MODELMESHCOLOR_SRGB colour{};
    if (type == NMR::MODELPROPERTYTYPE_BASEMATERIALS &&
        NMR::lib3mf_defaultpropertyhandler_getbasematerial(fallback, &group, &index) == LIB3MF_OK)
      set_material(object, t, material(group, index));
    if (type == NMR::MODELPROPERTYTYPE_COLOR &&
        NMR::lib3mf_defaultpropertyhandler_getcolor(fallback, 0, &colour) == LIB3MF_OK)
      set_colour(object, t, {{colour, colour, colour}});
  }

  static void set_material(ThreemfModel::Object& object, DWORD triangle, std::int32_t material) {
    object.materials.resize(object.triangles.size(), ThreemfModel::none);
    object.materials[triangle] = material;
  }

  static void set_colour(ThreemfModel::Object& object, DWORD triangle,
                         const NMR::MODELMESH_TRIANGLECOLOR_SRGB& colour) {
    std::array<std::uint8_t, 12> white;
    white.fill(255);
    object.colours.resize(object.triangles.size(), white);
    std::uint8_t* out = object.colours[triangle].data();
    for (const NMR::MODELMESHCOLOR_SRGB& corner : colour.m_Colors)
      for (const BYTE value : {corner.m_Red, corner.m_Green, corner.m_Blue, corner.m_Alpha}) *out++ = value;
  }

  // Returns the number of a base material. A material gets its number when it is first met.
  std::int32_t material(DWORD group, DWORD index) {
    const auto [entry, is_new] =
        material_of_.try_emplace({group, index}, static_cast<std::int32_t>(material_of_.size()));
    if (!is_new) return entry->second;
    Handle<NMR::PLib3MFModelBaseMaterial> materials;
    std::array<std::uint8_t, 4> colour = {255, 255, 255, 255};
    std::string name;
    if (NMR::lib3mf_model_getbasematerialbyid(session_.model(), group, materials.receive()) == LIB3MF_OK) {
      name = text_of([&](char* text, ULONG size, ULONG* needed) {
        return NMR::lib3mf_basematerial_getnameutf8(materials.get(), index, text, size, needed);
      });
      NMR::lib3mf_basematerial_getdisplaycolor(materials.get(), index, &colour[0], &colour[1], &colour[2],
                                               &colour[3]);
    }
    model_.material_names.push_back(name.empty() ? fmt::format("material_{}", entry->second) : name);
    model_.material_colours.push_back(colour);
    return entry->second;
  }

  void read_build() {
    Handle<NMR::PLib3MFModelBuildItemIterator> iterator;
    session_.require(NMR::lib3mf_model_getbuilditems(session_.model(), iterator.receive()), session_.model());
    for (BOOL more = 0; NMR::lib3mf_builditemiterator_movenext(iterator.get(), &more) == LIB3MF_OK && more;) {
      Handle<NMR::PLib3MFModelBuildItem> item;
      Handle<NMR::PLib3MFModelObjectResource> object;
      NMR::MODELTRANSFORM transform{};
      session_.require(NMR::lib3mf_builditemiterator_getcurrent(iterator.get(), item.receive()),
                       iterator.get());
      session_.require(NMR::lib3mf_builditem_getobjectresource(item.get(), object.receive()), item.get());
      session_.require(NMR::lib3mf_builditem_getobjecttransform(item.get(), &transform), item.get());
      add_placement(object.get(), affine(transform));
    }
    if (!model_.placements.empty()) return;
    for (std::size_t k = 0; k < model_.objects.size(); ++k)
      model_.placements.push_back({k, Eigen::Affine3d::Identity()});
  }

  void add_placement(NMR::PLib3MFModelObjectResource* object, const Eigen::Affine3d& transform) {
    BOOL is_components = 0;
    session_.require(NMR::lib3mf_object_iscomponentsobject(object, &is_components), object);
    if (!is_components) return place_mesh(object_of_.at(id_of(object)), transform);
    auto* components = static_cast<NMR::PLib3MFModelComponentsObject*>(object);
    DWORD count = 0;
    session_.require(NMR::lib3mf_componentsobject_getcomponentcount(components, &count), components);
    for (DWORD k = 0; k < count; ++k) {
      Handle<NMR::PLib3MFModelComponent> component;
      Handle<NMR::PLib3MFModelObjectResource> inner;
      NMR::MODELTRANSFORM own{};
      session_.require(NMR::lib3mf_componentsobject_getcomponent(components, k, component.receive()),
                       components);
      session_.require(NMR::lib3mf_component_getobjectresource(component.get(), inner.receive()),
                       component.get());
      session_.require(NMR::lib3mf_component_gettransform(component.get(), &own), component.get());
      add_placement(inner.get(), transform * affine(own));
    }
  }

  void place_mesh(std::size_t object, const Eigen::Affine3d& transform) {
    constexpr std::size_t most_vertices = 200'000'000;
    placed_vertices_ += model_.objects[object].vertices.size();
    if (placed_vertices_ > most_vertices)
      throw Error(
          facts::threemf::BuildTooLarge{.what = facts::threemf::Content::vertices, .most = most_vertices});
    model_.placements.push_back({object, transform});
  }

  Session session_;
  ThreemfModel model_;
  std::map<DWORD, std::size_t> object_of_;
  std::map<std::pair<DWORD, DWORD>, std::int32_t> material_of_;
  std::size_t placed_vertices_ = 0;
};

/// Writes a model.
class Writer {
 public:
  Writer(const ThreemfModel& model, const Context& context) : model_(model), session_(context) {}

  std::string write() {
    set_heading();
    add_materials();
    for (const ThreemfModel::Object& object : model_.objects) add_object(object);
    return serialise();
  }

 private:
  // lib3mf would give every object a random identifier. With fixed ones the same model gives the same bytes.
  std::string next_uuid() { return fmt::format("6d657368-6772-4166-8000-{:012x}", uuids_++); }

  void set_heading() {
    const auto unit = std::find(units.begin(), units.end(), model_.unit) - units.begin();
    session_.require(NMR::lib3mf_model_setunit(session_.model(), static_cast<DWORD>(unit)), session_.model());
    session_.require(NMR::lib3mf_model_setbuilduuidutf8(session_.model(), next_uuid().c_str()),
                     session_.model());
    session_.require(
        NMR::lib3mf_model_addmetadatautf8(session_.model(), "Application", "meshgraft " MESHGRAFT_VERSION),
        session_.model());
  }

  void add_materials() {
    if (model_.material_names.empty()) return;
    session_.require(NMR::lib3mf_model_addbasematerialgroup(session_.model(), materials_.receive()),
                     session_.model());
    session_.require(NMR::lib3mf_basematerial_getresourceid(materials_.get(), &material_group_),
                     materials_.get());
    for (std::size_t k = 0; k < model_.material_names.size(); ++k) {
      DWORD index = 0;
      const auto& colour = model_.material_colours[k];
      session_.require(
          NMR::lib3mf_basematerial_addmaterialutf8(materials_.get(), model_.material_names[k].c_str(),
                                                   colour[0], colour[1], colour[2], &index),
          materials_.get());
      session_.require(NMR::lib3mf_basematerial_setdisplaycolorrgba(materials_.get(), index, colour[0],
                                                                    colour[1], colour[2], colour[3]),
                       materials_.get());
    }
  }

  void add_object(const ThreemfModel::Object& object) {
    session_.context().throw_if_stopped();
    Handle<NMR::PLib3MFModelMeshObject> mesh;
    session_.require(NMR::lib3mf_model_addmeshobject(session_.model(), mesh.receive()), session_.model());
    if (!object.name.empty())
      session_.require(NMR::lib3mf_object_setnameutf8(mesh.get(), object.name.c_str()), mesh.get());
    session_.require(NMR::lib3mf_object_setuuidutf8(mesh.get(), next_uuid().c_str()), mesh.get());
    std::vector<std::array<float, 3>> vertices = object.vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles = object.triangles;
    session_.require(
        NMR::lib3mf_meshobject_setgeometry(mesh.get(), reinterpret_cast<NMR::MODELMESHVERTEX*>(vertices.data()),
                                           static_cast<DWORD>(vertices.size()),
                                           reinterpret_cast<NMR::MODELMESHTRIANGLE*>(triangles.data()),
                                           static_cast<DWORD>(triangles.size())),
        mesh.get());
    session_.context().throw_if_stopped();
    set_type(mesh.get(), object);
    session_.context().throw_if_stopped();
    add_properties(mesh.get(), object);
    Handle<NMR::PLib3MFModelBuildItem> item;
    session_.require(NMR::lib3mf_model_addbuilditem(session_.model(), mesh.get(), nullptr, item.receive()),
                     session_.model());
    session_.require(NMR::lib3mf_builditem_setuuidutf8(item.get(), next_uuid().c_str()), item.get());
  }

  // Sets the object's type. A closed mesh is a solid, an open one is a surface.
  void set_type(NMR::PLib3MFModelMeshObject* mesh, const ThreemfModel::Object& object) const {
    const bool closed = is_closed(object);
    const DWORD type = closed ? NMR::MODELOBJECTTYPE_MODEL : NMR::MODELOBJECTTYPE_SURFACE;
    session_.require(NMR::lib3mf_object_settype(mesh, type), mesh);
  }

  // Returns whether each edge has one triangle on either side, and the two run along it in opposite directions.
  bool is_closed(const ThreemfModel::Object& object) const {
    Faces faces;
    faces.reserve(static_cast<Index>(object.triangles.size()), static_cast<Index>(3 * object.triangles.size()));
    for (const auto& [a, b, c] : object.triangles)
      faces.push_back(std::array{static_cast<Index>(a), static_cast<Index>(b), static_cast<Index>(c)});
    const EdgeTable table(static_cast<Index>(object.vertices.size()), faces, session_.context());
    for (Index e = 0; e < table.edge_count(); ++e) {
      const auto along = table.half_edges[e];
      if (along.size() != 2 || faces.corners()[along[0]] == faces.corners()[along[1]]) return false;
    }
    return table.edge_count() > 0 && table.usable_faces == faces.size();
  }

  void add_properties(NMR::PLib3MFModelMeshObject* mesh, const ThreemfModel::Object& object) const {
    if (object.materials.empty() && object.colours.empty()) return;
    Handle<NMR::PLib3MFPropertyHandler> properties;
    Handle<NMR::PLib3MFDefaultPropertyHandler> fallback;
    session_.require(NMR::lib3mf_meshobject_createpropertyhandler(mesh, properties.receive()), mesh);
    session_.require(NMR::lib3mf_object_createdefaultpropertyhandler(mesh, fallback.receive()), mesh);
    // A mesh whose triangles have properties needs a default for those that have none.
    if (!object.colours.empty()) {
      session_.require(NMR::lib3mf_defaultpropertyhandler_setcolorrgba(fallback.get(), 255, 255, 255, 255),
                       fallback.get());
    } else {
      const auto named = std::find_if(object.materials.begin(), object.materials.end(),
                                      [](std::int32_t m) { return m != ThreemfModel::none; });
      const auto first = named == object.materials.end() ? 0 : static_cast<DWORD>(*named);
      session_.require(
          NMR::lib3mf_defaultpropertyhandler_setbasematerial(fallback.get(), material_group_, first),
          fallback.get());
    }
    SparseChecks check(session_.context(), triangles_per_check);
    for (std::size_t t = 0; t < object.triangles.size(); ++t) {
      check();
      const auto triangle = static_cast<DWORD>(t);
      if (!object.materials.empty() && object.materials[t] != ThreemfModel::none) {
        session_.require(
            NMR::lib3mf_propertyhandler_setbasematerial(properties.get(), triangle, material_group_,
                                                        static_cast<DWORD>(object.materials[t])),
            properties.get());
      } else if (!object.colours.empty()) {
        NMR::MODELMESH_TRIANGLECOLOR_SRGB colour{};
        for (std::size_t c = 0; c < 3; ++c) {
          const std::uint8_t* value = object.colours[t].data() + 4 * c;
          colour.m_Colors[c] = {value[0], value[1], value[2], value[3]};
        }
        session_.require(NMR::lib3mf_propertyhandler_setgradientcolor(properties.get(), triangle, &colour),
                         properties.get());
      }
    }
  }

  std::string serialise() const {
    Handle<NMR::PLib3MFModelWriter> writer;
    session_.require(NMR::lib3mf_model_querywriter(session_.model(), "3mf", writer.receive()),
                     session_.model());
    NMR::lib3mf_writer_setprogresscallback(writer.get(), &Session::go_on,
                                           const_cast<Context*>(&session_.context()));
    ULONG64 size = 0;
    session_.require(NMR::lib3mf_writer_getstreamsize(writer.get(), &size), writer.get());
    std::string bytes(size, '\0');
    auto* begin = reinterpret_cast<BYTE*>(bytes.data());
    session_.require(NMR::lib3mf_writer_writetobuffer(writer.get(), begin, size), writer.get());
    return bytes;
  }

  const ThreemfModel& model_;
  Session session_;
  Handle<NMR::PLib3MFModelBaseMaterial> materials_;
  DWORD material_group_ = 0;
  unsigned uuids_ = 1;
};

}  // namespace

ThreemfModel read_threemf_model(std::string_view package, const std::string& name, const Context& context) try {
  return Reader(context).read(package);
} catch (const Error& error) {
  throw error.code() == ErrorCode::cancelled ? error : error.within(Location::file(name));
}

std::string write_threemf_model(const ThreemfModel& model, const Context& context) {
  return Writer(model, context).write();
}

}  // namespace meshgraft::io
