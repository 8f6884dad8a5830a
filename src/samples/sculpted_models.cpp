#include "models.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

namespace meshgraft::samples {

namespace {

constexpr double pi = std::numbers::pi;

double radians(double degrees) { return degrees * pi / 180.0; }

Eigen::Matrix3d turned(double angle_deg, const Vec3& axis) {
  return Eigen::AngleAxisd(radians(angle_deg), axis.normalized()).toRotationMatrix();
}

// Returns a Catmull-Rom curve through the knots, including their radii.
std::vector<Knot> smooth_chain(const std::vector<Knot>& knots, int pieces = 5) {
  std::vector<Knot> out;
  const auto knot = [&](int i) { return knots[std::clamp(i, 0, static_cast<int>(knots.size()) - 1)]; };
  const auto spline = [](double t, auto a, auto b, auto c, auto d) {
    return (0.5 * ((2.0 * b) + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * (t * t) +
                   (3.0 * b - a - 3.0 * c + d) * (t * t * t)));
  };
  for (int k = 0; k + 1 < static_cast<int>(knots.size()); ++k)
    for (int i = 0; i < pieces; ++i) {
      const double t = static_cast<double>(i) / pieces;
      const Knot a = knot(k - 1), b = knot(k), c = knot(k + 1), d = knot(k + 2);
      const Vec3 point(spline(t, a.point.x(), b.point.x(), c.point.x(), d.point.x()),
                       spline(t, a.point.y(), b.point.y(), c.point.y(), d.point.y()),
                       spline(t, a.point.z(), b.point.z(), c.point.z(), d.point.z()));
      out.push_back({point, std::max(0.5 * std::min(b.radius, c.radius),
                                     spline(t, a.radius, b.radius, c.radius, d.radius))});
    }
  out.push_back(knots.back());
  return out;
}

Vec3 mirrored(const Vec3& p, int side) { return {side * p.x(), p.y(), p.z()}; }

std::vector<Knot> mirrored(std::vector<Knot> knots, int side) {
  for (Knot& knot : knots) knot.point = mirrored(knot.point, side);
  return knots;
}

// Adds an arm of the octopus, which sinks to the ground, winds outwards and curls up at its tip. Its suckers
// form two rows on the underside.
void octopus_arm(Sculpture& sculpture, int arm) {
  const Vec3 skin(0.80, 0.36, 0.27), pale(0.95, 0.78, 0.66);
  const double azimuth = radians(22.5 + 45.0 * arm);
  const double character = hash_unit(static_cast<unsigned>(arm), 1, 0, 7);
  const double wave = (arm % 2 == 0 ? 1.0 : -1.0) * radians(34.0 + 14.0 * character);
  const double curl = radians(300.0 + 40.0 * hash_unit(static_cast<unsigned>(arm), 2, 0, 7));
  constexpr int pieces = 44;
  constexpr double length = 2.7;
  const auto radius = [](double t) { return 0.035 + 0.185 * std::pow(1.0 - t, 1.1); };

  std::vector<Knot> knots;
  struct Frame {
    Vec3 point, under, side;
  };
  std::vector<Frame> frames;
  Vec3 p(0.30 * std::cos(azimuth), 0.30 * std::sin(azimuth), 0.52);
  for (int i = 0; i <= pieces; ++i) {
    const double t = static_cast<double>(i) / pieces;
    const double rise = std::clamp((t - 0.50) / 0.50, 0.0, 1.0);
    const double pitch =
        -radians(40.0) * std::pow(std::clamp(1.0 - t / 0.42, 0.0, 1.0), 0.8) + curl * rise * rise;
    const double yaw = azimuth + wave * std::sin(2.0 * pi * std::min(t, 0.8) / 0.8);
    const Vec3 ahead(std::cos(yaw), std::sin(yaw), 0.0);
    const Vec3 tangent = std::cos(pitch) * ahead + std::sin(pitch) * Vec3::UnitZ();
    const Vec3 under = std::sin(pitch) * ahead - std::cos(pitch) * Vec3::UnitZ();
    knots.push_back({p, radius(t)});
    frames.push_back({p, under, tangent.cross(under)});
    p += length / pieces * tangent;
  }
  sculpture.chain(knots, {.colour = skin, .blend = 0.16});

  // The paler underside, slightly raised from the arm.
  std::vector<Knot> belly;
  for (int i = 3; i <= pieces; ++i) {
    const double r = knots[i].radius;
    belly.push_back({frames[i].point + 0.30 * r * frames[i].under, 0.74 * r});
  }
  sculpture.chain(belly, {.colour = pale, .blend = 0.03});

  // Stamped cups: a rim around a hollow.
  double along = 0.16;
  for (int k = 0; along < 0.97; ++k) {
    const int i = static_cast<int>(along * pieces);
    const double r = radius(along), cup = 0.40 * r;
    const double lean = (k % 2 == 0 ? 1.0 : -1.0) * radians(36.0);
    const Frame& frame = frames[i];
    const double rest = along * pieces - i;
    const Vec3 centre = frame.point + rest * (frames[std::min(i + 1, pieces)].point - frame.point);
    const Vec3 out = std::cos(lean) * frame.under + std::sin(lean) * frame.side;
    const Vec3 seat = centre + 1.03 * r * out;
    sculpture.ellipsoid(seat + 0.25 * cup * out, Vec3::Constant(0.62 * cup),
                        {.colour = Vec3(0.80, 0.50, 0.42), .blend = 0.4 * cup, .carve = true});
    sculpture.ring(seat + 0.05 * cup * out, out, 0.72 * cup, 0.30 * cup,
                   {.colour = Vec3(0.98, 0.88, 0.78), .blend = 0.25 * cup});
    along += 1.15 * cup / length;
  }
}

}  // namespace

SculptedModel octopus() {
  SculptedModel model;
  Sculpture& s = model.sculpture;
  const Vec3 skin(0.82, 0.37, 0.27), bright(0.90, 0.50, 0.34);
  for (int arm = 0; arm < 8; ++arm) octopus_arm(s, arm);
  s.ellipsoid({0, 0, 0.60}, {0.44, 0.44, 0.34}, {.colour = skin, .blend = 0.25});
  s.ellipsoid({0, -0.08, 0.95}, {0.38, 0.36, 0.36}, {.colour = skin, .blend = 0.20});
  s.ellipsoid({0, 0.26, 1.50}, {0.56, 0.58, 0.74}, {.colour = bright, .blend = 0.30},
              turned(-24.0, Vec3::UnitX()));
  for (const int side : {-1, 1}) {
    s.ellipsoid(mirrored({0.27, -0.27, 1.10}, side), {0.17, 0.17, 0.18}, {.colour = skin, .blend = 0.12});
    s.ellipsoid(mirrored({0.315, -0.36, 1.12}, side), Vec3::Constant(0.115),
                {.colour = Vec3(0.97, 0.94, 0.86), .blend = 0.015});
    s.ellipsoid(mirrored({0.345, -0.435, 1.12}, side), {0.035, 0.052, 0.062},
                {.colour = Vec3(0.05, 0.05, 0.07), .blend = 0.01}, turned(side * 38.0, Vec3::UnitZ()));
    // The lid, a cap over the eyeball.
    s.ellipsoid(mirrored({0.310, -0.345, 1.190}, side), {0.132, 0.125, 0.085}, {.colour = skin, .blend = 0.03});
    // The siphon's tubes beside the head.
    const std::vector<Knot> tube{
        {{0.30, 0.20, 0.90}, 0.10}, {{0.44, 0.14, 0.86}, 0.085}, {{0.53, 0.02, 0.84}, 0.075}};
    s.chain(smooth_chain(mirrored(tube, side)), {.colour = skin, .blend = 0.08});
    s.ellipsoid(mirrored({0.56, -0.03, 0.835}, side), Vec3::Constant(0.05),
                {.colour = Vec3(0.35, 0.12, 0.10), .blend = 0.03, .carve = true});
  }
  // Warts on the mantle.
  for (unsigned k = 0; k < 46; ++k) {
    const double z = 0.95 - 1.35 * (k + 0.5) / 46.0, turn = k * 2.39996;
    const double across = std::sqrt(std::max(0.0, 1.0 - z * z));
    const Vec3 local(0.56 * across * std::cos(turn), 0.58 * across * std::sin(turn), 0.74 * z);
    const Vec3 place = Vec3(0, 0.26, 1.50) + turned(-24.0, Vec3::UnitX()) * local;
    if (place.y() < -0.12 && place.z() < 1.35) continue;
    const double size = 0.035 + 0.03 * hash_unit(k, 0, 0, 3);
    s.ellipsoid(place, Vec3::Constant(size), {.colour = Vec3(0.97, 0.66, 0.44), .blend = 0.05});
  }
  model.area = 19.9;
  model.finest_cell = 0.03;
  return model;
}

namespace {

const Vec3 human_skin(0.90, 0.70, 0.58);

// Head and bust share the neck, so that one fits on the other.
std::vector<Knot> neck() {
  return smooth_chain(
      {{{0, 0.13, -0.75}, 0.25}, {{0, 0.12, -0.45}, 0.20}, {{0, 0.10, -0.15}, 0.185}, {{0, 0.08, 0.15}, 0.19}});
}

void eye(Sculpture& s, int side) {
  const Vec3 skin = human_skin;
  s.ellipsoid(mirrored({0.135, -0.385, 0.490}, side), {0.085, 0.070, 0.058},
              {.colour = skin, .blend = 0.07, .carve = true});
  const Vec3 ball = mirrored({0.132, -0.243, 0.490}, side);
  s.ellipsoid(ball, Vec3::Constant(0.068), {.colour = Vec3(0.97, 0.96, 0.94), .blend = 0.01});
  s.ellipsoid(ball + Vec3(0, -0.060, 0), {0.030, 0.013, 0.030},
              {.colour = Vec3(0.22, 0.36, 0.42), .blend = 0.003});
  s.ellipsoid(ball + Vec3(0, -0.067, 0), {0.015, 0.008, 0.015},
              {.colour = Vec3(0.04, 0.04, 0.05), .blend = 0.002});
  // Lids: two larger caps; their edges meet the ball in an almond.
  s.ellipsoid(ball + Vec3(0.002 * side, 0, 0.034), {0.082, 0.072, 0.054},
              {.colour = 0.93 * skin, .blend = 0.010});
  s.ellipsoid(ball + Vec3(0.002 * side, 0.004, -0.044), {0.082, 0.068, 0.052},
              {.colour = 0.97 * skin, .blend = 0.014});
  const std::vector<Knot> brow{{{0.050, -0.349, 0.588}, 0.013},
                               {{0.110, -0.333, 0.612}, 0.018},
                               {{0.180, -0.292, 0.612}, 0.016},
                               {{0.238, -0.238, 0.585}, 0.010}};
  s.chain(smooth_chain(mirrored(brow, side)), {.colour = Vec3(0.36, 0.24, 0.17), .blend = 0.03});
}

void ear(Sculpture& s, int side) {
  const Eigen::Matrix3d tilt = turned(side * -18.0, Vec3::UnitZ()) * turned(12.0, Vec3::UnitX());
  s.ellipsoid(mirrored({0.310, 0.070, 0.43}, side), {0.055, 0.075, 0.110},
              {.colour = human_skin, .blend = 0.04}, tilt);
  s.ellipsoid(mirrored({0.340, 0.075, 0.42}, side), {0.045, 0.090, 0.130},
              {.colour = human_skin, .blend = 0.04}, tilt);
  s.ellipsoid(mirrored({0.395, 0.060, 0.435}, side), {0.034, 0.048, 0.080},
              {.colour = 0.88 * human_skin, .blend = 0.03, .carve = true}, tilt);
  const std::vector<Knot> helix{{{0.345, 0.010, 0.46}, 0.018},  {{0.362, 0.025, 0.52}, 0.021},
                                {{0.378, 0.080, 0.548}, 0.023}, {{0.388, 0.135, 0.510}, 0.023},
                                {{0.375, 0.140, 0.420}, 0.021}, {{0.348, 0.085, 0.325}, 0.026}};
  s.chain(smooth_chain(mirrored(helix, side)), {.colour = human_skin, .blend = 0.035});
}

void mouth(Sculpture& s) {
  const Vec3 lips(0.80, 0.46, 0.42);
  s.ellipsoid({0, -0.29, 0.20}, {0.115, 0.085, 0.075}, {.colour = human_skin, .blend = 0.06});
  // The upper lip in two wings, the lower lip and the line between, with slightly raised corners.
  s.chain(smooth_chain({{{-0.110, -0.320, 0.206}, 0.008},
                        {{-0.055, -0.368, 0.217}, 0.018},
                        {{-0.018, -0.387, 0.226}, 0.021},
                        {{0, -0.388, 0.221}, 0.020},
                        {{0.018, -0.387, 0.226}, 0.021},
                        {{0.055, -0.368, 0.217}, 0.018},
                        {{0.110, -0.320, 0.206}, 0.008}}),
          {.colour = lips, .blend = 0.02});
  s.chain(smooth_chain({{{-0.100, -0.325, 0.200}, 0.008},
                        {{-0.045, -0.365, 0.177}, 0.024},
                        {{0, -0.375, 0.172}, 0.029},
                        {{0.045, -0.365, 0.177}, 0.024},
                        {{0.100, -0.325, 0.200}, 0.008}}),
          {.colour = lips, .blend = 0.015});
  s.chain(smooth_chain({{{-0.118, -0.330, 0.209}, 0.010},
                        {{-0.05, -0.388, 0.200}, 0.010},
                        {{0, -0.404, 0.198}, 0.010},
                        {{0.05, -0.388, 0.200}, 0.010},
                        {{0.118, -0.330, 0.209}, 0.010}}),
          {.colour = 0.7 * lips, .blend = 0.024, .carve = true});
}

// Adds a cap of hair locks, combed from the forehead over the top to the nape. The locks are half-sunk tubes
// along the cap.
void hair(Sculpture& s) {
  const Vec3 brown(0.42, 0.27, 0.18), centre(0, 0.115, 0.650), radii(0.372, 0.405, 0.400);
  const Eigen::Matrix3d tilt = turned(-15.0, Vec3::UnitX());
  s.ellipsoid(centre, radii, {.colour = brown, .blend = 0.015}, tilt);
  constexpr int half_count = 7;
  for (int k = -half_count; k <= half_count; ++k) {
    const double across = std::sin(1.42 * k / half_count), rest = std::sqrt(1.0 - across * across);
    std::vector<Knot> lock;
    constexpr int pieces = 14;
    for (int i = 0; i <= pieces; ++i) {
      const double t = static_cast<double>(i) / pieces;
      const double sway = 0.05 * std::sin(3.0 * t + 1.7 * k);
      const double angle = radians(29.0 + 6.0 * (k % 2) + 156.0 * t);
      const Vec3 local(radii.x() * (across + sway * rest), -radii.y() * rest * std::cos(angle),
                       radii.z() * rest * std::sin(angle));
      lock.push_back({centre + tilt * ((0.935 + 0.045 * std::sqrt(std::sin(pi * t))) * local),
                      0.014 + 0.044 * rest * std::sin(pi * std::min(1.0, 0.08 + 0.92 * t))});
    }
    s.chain(lock, {.colour = (k % 2 == 0 ? 1.0 : 1.18) * brown, .blend = 0.02});
  }
}

}  // namespace

SculptedModel head() {
  SculptedModel model;
  Sculpture& s = model.sculpture;
  const Brush soft{.colour = human_skin, .blend = 0.12};
  s.chain(neck(), soft);
  s.ellipsoid({0, 0.06, 0.60}, {0.345, 0.41, 0.40}, soft);
  s.ellipsoid({0, -0.12, 0.30}, {0.255, 0.23, 0.33}, soft);
  s.ellipsoid({0, -0.25, 0.060}, {0.105, 0.080, 0.070}, {.colour = human_skin, .blend = 0.10});
  for (const int side : {-1, 1}) {
    const std::vector<Knot> jaw{
        {{0.225, 0.02, 0.30}, 0.06}, {{0.195, -0.06, 0.13}, 0.06}, {{0.08, -0.23, 0.050}, 0.06}};
    s.chain(smooth_chain(mirrored(jaw, side)), {.colour = human_skin, .blend = 0.10});
    s.ellipsoid(mirrored({0.165, -0.215, 0.355}, side), {0.085, 0.075, 0.065},
                {.colour = Vec3(0.93, 0.66, 0.56), .blend = 0.14});
    eye(s, side);
    ear(s, side);
    s.ellipsoid(mirrored({0.045, -0.372, 0.322}, side), {0.032, 0.042, 0.030},
                {.colour = human_skin, .blend = 0.055});
  }
  s.chain(smooth_chain({{{0, -0.325, 0.560}, 0.032},
                        {{0, -0.365, 0.480}, 0.035},
                        {{0, -0.415, 0.400}, 0.042},
                        {{0, -0.445, 0.345}, 0.050}}),
          {.colour = human_skin, .blend = 0.07});
  s.ellipsoid({0, -0.375, 0.345}, {0.046, 0.065, 0.045}, {.colour = human_skin, .blend = 0.04});
  for (const int side : {-1, 1})
    s.ellipsoid(mirrored({0.028, -0.420, 0.290}, side), {0.015, 0.022, 0.014},
                {.colour = 0.7 * human_skin, .blend = 0.015, .carve = true});
  mouth(s);
  hair(s);
  model.area = 3.3;
  model.finest_cell = 0.025;
  model.cut = true;
  model.cut_height = -0.40;
  return model;
}

SculptedModel bust() {
  SculptedModel model;
  Sculpture& s = model.sculpture;
  const auto skin = [](double blend) { return Brush{.colour = human_skin, .blend = blend}; };
  s.ellipsoid({0, 0.11, -1.10}, {0.64, 0.33, 0.66}, skin(0.18));
  s.chain(neck(), skin(0.18));
  for (const int side : {-1, 1}) {
    const auto stroke = [&](std::vector<Knot> knots, double blend) {
      s.chain(smooth_chain(mirrored(std::move(knots), side)), skin(blend));
    };
    stroke({{{0.08, 0.16, -0.50}, 0.13}, {{0.40, 0.15, -0.68}, 0.15}, {{0.70, 0.12, -0.86}, 0.19}}, 0.16);
    stroke({{{0.73, 0.12, -0.90}, 0.205}, {{0.81, 0.12, -1.15}, 0.195}, {{0.84, 0.10, -1.45}, 0.165}}, 0.10);
    s.ellipsoid(mirrored({0.29, -0.09, -1.02}, side), {0.30, 0.125, 0.20}, skin(0.22),
                turned(side * 14.0, Vec3::UnitY()));
    // The collar bone, and the muscle from behind the ear to the pit of the throat.
    stroke({{{0.045, -0.135, -0.73}, 0.036}, {{0.25, -0.115, -0.705}, 0.031}, {{0.50, -0.01, -0.675}, 0.034}},
           0.08);
    stroke({{{0.165, 0.06, -0.12}, 0.04}, {{0.11, -0.04, -0.42}, 0.047}, {{0.045, -0.125, -0.70}, 0.04}}, 0.10);
  }
  s.half_space({0, 0, -1.34}, {0, 0, 1}, {.colour = human_skin, .blend = 0.06, .carve = true});
  model.area = 4.84;
  model.finest_cell = 0.06;
  model.cut = true;
  model.cut_height = -0.28;
  model.keep_above = false;
  return model;
}

SculptedModel dinosaur() {
  SculptedModel model;
  Sculpture& s = model.sculpture;
  const Vec3 skin(0.45, 0.58, 0.42), belly(0.80, 0.80, 0.62), plate(0.72, 0.46, 0.30);
  const Brush soft{.colour = skin, .blend = 0.18};
  // The model looks along −x.
  s.ellipsoid({0, 0, 1.30}, {0.95, 0.52, 0.56}, soft);
  s.ellipsoid({0.45, 0, 1.32}, {0.62, 0.50, 0.54}, soft);
  s.chain(smooth_chain({{{-0.55, 0, 1.42}, 0.42},
                        {{-1.00, 0, 1.78}, 0.27},
                        {{-1.30, 0, 2.25}, 0.205},
                        {{-1.45, 0, 2.75}, 0.17},
                        {{-1.58, 0, 3.12}, 0.155},
                        {{-1.80, 0, 3.32}, 0.15}}),
          soft);
  s.chain(smooth_chain({{{0.65, 0, 1.36}, 0.44},
                        {{1.25, 0, 1.24}, 0.29},
                        {{1.85, 0.06, 0.98}, 0.18},
                        {{2.45, 0.16, 0.80}, 0.115},
                        {{3.05, 0.22, 0.80}, 0.07},
                        {{3.55, 0.18, 0.95}, 0.035}}),
          soft);
  s.ellipsoid({-0.05, 0, 1.13}, {0.88, 0.46, 0.46}, {.colour = belly, .blend = 0.10});
  // Head.
  s.ellipsoid({-1.90, 0, 3.37}, {0.28, 0.205, 0.205}, {.colour = skin, .blend = 0.12});
  s.ellipsoid({-2.17, 0, 3.27}, {0.25, 0.165, 0.130}, {.colour = skin, .blend = 0.10});
  s.chain(smooth_chain({{{-1.99, -0.190, 3.215}, 0.010},
                        {{-2.22, -0.168, 3.210}, 0.012},
                        {{-2.39, -0.09, 3.220}, 0.012},
                        {{-2.43, 0, 3.225}, 0.012},
                        {{-2.39, 0.09, 3.220}, 0.012},
                        {{-2.22, 0.168, 3.210}, 0.012},
                        {{-1.99, 0.190, 3.215}, 0.010}}),
          {.colour = 0.6 * skin, .blend = 0.025, .carve = true});
  for (const int side : {-1, 1}) {
    const auto flank = [side](double x, double y, double z) { return Vec3(x, side * y, z); };
    s.ellipsoid(flank(-1.97, 0.150, 3.44), {0.100, 0.08, 0.100}, {.colour = skin, .blend = 0.06});
    s.ellipsoid(flank(-1.99, 0.182, 3.44), Vec3::Constant(0.070),
                {.colour = Vec3(0.96, 0.92, 0.75), .blend = 0.008});
    s.ellipsoid(flank(-2.008, 0.238, 3.442), {0.032, 0.018, 0.038},
                {.colour = Vec3(0.05, 0.05, 0.05), .blend = 0.004});
    s.ellipsoid(flank(-2.385, 0.060, 3.330), Vec3::Constant(0.022),
                {.colour = 0.5 * skin, .blend = 0.025, .carve = true});
    // Fore and hind legs, each with a foot of three toes.
    const auto leg = [&](const std::vector<Knot>& knots) {
      s.chain(smooth_chain(knots), {.colour = skin, .blend = 0.14});
      const Vec3 foot = knots.back().point;
      for (const int toe : {-1, 0, 1})
        s.ellipsoid(foot + Vec3(-0.155 + 0.03 * toe * toe, 0.105 * toe, -0.075), {0.075, 0.055, 0.065},
                    {.colour = belly, .blend = 0.03});
    };
    leg({{flank(-0.52, 0.30, 1.20), 0.27},
         {flank(-0.55, 0.37, 0.80), 0.205},
         {flank(-0.50, 0.38, 0.45), 0.165},
         {flank(-0.53, 0.38, 0.15), 0.175}});
    leg({{flank(0.55, 0.28, 1.25), 0.34},
         {flank(0.52, 0.38, 0.85), 0.25},
         {flank(0.66, 0.39, 0.48), 0.175},
         {flank(0.60, 0.39, 0.15), 0.18}});
  }
  // Flat soles.
  s.half_space({0, 0, 0}, {0, 0, 1}, {.colour = belly, .blend = 0.05, .carve = true});
  // A crest of spines from neck to tail.
  const std::vector<Knot> back = smooth_chain({{{-1.62, 0, 3.42}, 0.05},
                                               {{-1.27, 0, 2.80}, 0.055},
                                               {{-1.08, 0, 2.30}, 0.065},
                                               {{-0.72, 0, 1.98}, 0.075},
                                               {{-0.20, 0, 1.87}, 0.09},
                                               {{0.40, 0, 1.87}, 0.09},
                                               {{0.95, 0, 1.66}, 0.08},
                                               {{1.45, 0.02, 1.40}, 0.065},
                                               {{1.95, 0.07, 1.12}, 0.05},
                                               {{2.45, 0.16, 0.925}, 0.04}},
                                              3);
  for (std::size_t k = 0; k + 1 < back.size(); ++k) {
    const Vec3 along = (back[k + 1].point - back[k].point).normalized();
    const Vec3 up = (along.x() < 0 ? -1.0 : 1.0) * Vec3(-along.z(), 0, along.x()).normalized();
    const double size = back[k].radius;
    const Vec3 tip = back[k].point + 2.1 * size * up;
    s.chain(std::vector<Knot>{{back[k].point - size * up, size}, {tip, 0.25 * size}},
            {.colour = plate, .blend = 0.04});
  }
  // Skin: soft wrinkles and scales.
  s.set_relief([](const Vec3& x) { return 0.006 * noise(9.0 * x, 11) + 0.004 * noise(19.0 * x, 12); }, 0.01);
  model.area = 17.2;
  model.finest_cell = 0.045;
  return model;
}

SculptedModel cactus() {
  SculptedModel model;
  Sculpture& s = model.sculpture;
  const Vec3 green(0.36, 0.55, 0.32), pink(0.90, 0.40, 0.52), yellow(0.97, 0.82, 0.36);
  const Ribs ribs{12, 0.16};
  s.chain(smooth_chain({{{0, 0, -0.3}, 0.34},
                        {{0, 0, 0.5}, 0.37},
                        {{0.01, 0, 1.3}, 0.37},
                        {{0.0, 0, 2.05}, 0.32},
                        {{0, 0, 2.35}, 0.27}}),
          {.colour = green, .blend = 0.06}, ribs);
  const std::vector<std::vector<Knot>> arms{{{{0.20, 0, 0.95}, 0.19},
                                             {{0.52, 0, 0.92}, 0.19},
                                             {{0.82, 0, 1.02}, 0.20},
                                             {{0.95, 0, 1.32}, 0.20},
                                             {{0.96, 0, 1.65}, 0.185},
                                             {{0.95, 0, 1.85}, 0.15}},
                                            {{{-0.20, 0, 1.25}, 0.17},
                                             {{-0.50, 0, 1.23}, 0.17},
                                             {{-0.74, 0.02, 1.33}, 0.175},
                                             {{-0.85, 0.02, 1.60}, 0.175},
                                             {{-0.86, 0.02, 1.95}, 0.165},
                                             {{-0.85, 0.02, 2.15}, 0.13}},
                                            {{{0.05, -0.20, 0.70}, 0.14},
                                             {{0.08, -0.48, 0.70}, 0.14},
                                             {{0.10, -0.66, 0.80}, 0.145},
                                             {{0.10, -0.72, 1.00}, 0.14},
                                             {{0.10, -0.72, 1.18}, 0.11}}};
  for (const auto& arm : arms) s.chain(smooth_chain(arm), {.colour = green, .blend = 0.10}, {9, 0.15});
  // Flowers on the trunk and the first two arms.
  const auto flower = [&](const Vec3& centre, double size, const Vec3& colour) {
    for (int k = 0; k < 6; ++k) {
      const double turn = k * pi / 3.0;
      const Vec3 out(std::cos(turn), std::sin(turn), 0.0);
      s.ellipsoid(centre + 0.66 * size * out + Vec3(0, 0, 0.12 * size), {0.62 * size, 0.46 * size, 0.30 * size},
                  {.colour = colour, .blend = 0.18 * size},
                  turned(60.0 * k, Vec3::UnitZ()) * turned(-30.0, Vec3::UnitY()));
    }
    s.ellipsoid(centre + Vec3(0, 0, 0.15 * size), Vec3::Constant(0.42 * size),
                {.colour = yellow, .blend = 0.06 * size});
  };
  flower({0, 0, 2.62}, 0.20, pink);
  flower({0.95, 0, 1.99}, 0.15, pink);
  flower({-0.85, 0.02, 2.27}, 0.14, pink);
  s.half_space({0, 0, 0}, {0, 0, 1}, {.colour = green, .blend = 0.05, .carve = true});
  model.area = 11.0;
  model.finest_cell = 0.06;
  return model;
}

SculptedModel bracket() {
  SculptedModel model;
  Sculpture& s = model.sculpture;
  const Brush steel{.colour = {0.56, 0.62, 0.70}, .blend = 0.03};
  // A disc: a ball between two planes.
  s.ellipsoid({0, 0, 0}, Vec3::Constant(1.0), steel);
  s.half_space({0, 0, 0.17}, {0, 0, -1}, {.colour = steel.colour, .blend = 0.03, .carve = true});
  s.half_space({0, 0, -0.17}, {0, 0, 1}, {.colour = steel.colour, .blend = 0.03, .carve = true});
  for (int k = 0; k < 4; ++k) {
    const Eigen::Matrix3d turn = turned(90.0 * k, Vec3::UnitZ());
    std::vector<Knot> leg{{{0.72, 0, 0.0}, 0.20},
                          {{0.98, 0, -0.10}, 0.20},
                          {{1.10, 0, -0.38}, 0.19},
                          {{1.10, 0, -0.80}, 0.18},
                          {{1.10, 0, -1.30}, 0.18}};
    for (Knot& knot : leg) knot.point = turn * knot.point;
    s.chain(smooth_chain(leg), {.colour = steel.colour, .blend = 0.08});
    const Vec3 bolt = turned(45.0, Vec3::UnitZ()) * turn * Vec3(0.70, 0, 0);
    const std::vector<Knot> hole{{bolt + Vec3(0, 0, 0.6), 0.10}, {bolt - Vec3(0, 0, 0.6), 0.10}};
    s.chain(hole, {.colour = steel.colour, .blend = 0.02, .carve = true});
  }
  const std::vector<Knot> bore{{{0, 0, 0.6}, 0.34}, {{0, 0, -0.6}, 0.34}};
  s.chain(bore, {.colour = steel.colour, .blend = 0.02, .carve = true});
  model.area = 10.5;
  model.finest_cell = 0.05;
  model.cut = true;
  model.cut_height = -1.0;
  return model;
}

SculptedModel posts() {
  SculptedModel model;
  Sculpture& s = model.sculpture;
  const Vec3 oak(0.72, 0.55, 0.38);
  struct Post {
    double x, y, radius;
  };
  for (const Post& post :
       {Post{1.35, 0.15, 0.15}, Post{-0.10, 1.25, 0.26}, Post{-1.20, -0.10, 0.20}, Post{0.10, -1.45, 0.12}}) {
    s.ellipsoid({post.x, post.y, 0.05}, {1.9 * post.radius, 1.9 * post.radius, 0.20},
                {.colour = oak, .blend = 0.02});
    const std::vector<Knot> shaft{{{post.x, post.y, 0}, 1.05 * post.radius},
                                  {{post.x, post.y, 0.7}, post.radius},
                                  {{post.x, post.y, 1.6}, post.radius}};
    s.chain(shaft, {.colour = oak, .blend = 0.08});
  }
  s.half_space({0, 0, 0}, {0, 0, 1}, {.colour = oak, .blend = 0.02, .carve = true});
  model.area = 7.0;
  model.finest_cell = 0.05;
  model.cut = true;
  model.cut_height = 1.2;
  model.keep_above = false;
  model.parts = 4;
  return model;
}

}  // namespace meshgraft::samples
