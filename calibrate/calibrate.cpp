// SPDX-License-Identifier: Apache-2.0
#include "calibrate/calibrate.h"

#include "calibrate/board_views.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "formats/model/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nearfield::calibrate {
namespace {

using capture::ShotKind;
using capture::TargetPlane;

bool holds(const capture::Capture& capture, ShotKind kind) {
    return std::any_of(capture.frames.begin(), capture.frames.end(),
                       [&](const auto& entry) { return entry.second.shot.kind == kind; });
}

// Radiometry needs the sensor's own frames, or at least photographs of a bracket.
bool tells_radiometry(const capture::Capture& capture) {
    return holds(capture, ShotKind::Flat) || holds(capture, ShotKind::Dark) ||
           holds(capture, ShotKind::Light);
}

bool has_view_on(const Observations& observations, TargetPlane plane) {
    return std::any_of(observations.boards.begin(), observations.boards.end(),
                       [&](const BoardView& view) { return view.plane == plane; });
}

Observations observe(const std::string& folder,
                     const capture::Capture& capture,
                     const CalibrationOptions& options) {
    Observations observations;
    observations.boards = board_views(folder, capture, [&](double fraction) {
        if (options.progress)
            options.progress("boards", fraction);
    });
    const capture::Plan& plan = *capture.header.plan;
    for (const auto& [number, frame] : capture.frames)
        if (frame.shot.kind == ShotKind::Target)
            observations.size_px = frame.size_px;
    observations.grid = plan.grid;
    observations.pitch_m = plan.pitch_m;
    return observations;
}

const ViewResult* first_view_on(const Geometry& geometry, TargetPlane plane) {
    const auto found = std::find_if(geometry.views.begin(), geometry.views.end(),
                                    [&](const ViewResult& view) { return view.plane == plane; });
    return found == geometry.views.end() ? nullptr : &*found;
}

// The filter's centers as the stage moves it, by way of the board that lay on U.
void measure_filters(const capture::Capture& capture,
                     const GeometryOptions& geometry_options,
                     const FrameReader& read,
                     Observations& observations,
                     RadiometryResult& radiometry) {
    const std::vector<ExposureGroup> groups = sorted_frames(capture).filters;
    if (groups.empty())
        return;
    GeometryOptions lens_alone = geometry_options;
    lens_alone.with_planes = false;
    lens_alone.with_validation = false;
    const Geometry first = calibrate_geometry(observations, lens_alone);
    const ViewResult* on_u = first_view_on(first, TargetPlane::Filter);
    if (on_u == nullptr)
        throw Error{"the filter's plane is not known", "views of the target",
                    "a view with the board on U (\"filter\" in the plan's targets.views)", "none"};
    FilterGeometry geometry;
    geometry.lens = first.lens;
    geometry.camera_from_u = on_u->camera_from_board;
    geometry.pitch_m = observations.pitch_m;
    observations.filters = measure_filter(
        groups, geometry, model::make_profile(capture.header.plan->basis), read, radiometry);
}

// The filter's own x axis against the slab's: it was measured against the board on U.
void set_filter_turn(const RadiometryResult& radiometry, Geometry& geometry) {
    const ViewResult* on_u = first_view_on(geometry, TargetPlane::Filter);
    if (!radiometry.filter || on_u == nullptr)
        return;
    const double turn_rad = radiometry.filter->turn_rad;
    rig::Planes& planes = geometry.planes->planes;
    const glm::dvec3 axis = glm::transpose(planes.camera_from_slab.rotation) *
                            on_u->camera_from_board.rotation *
                            glm::dvec3(std::cos(turn_rad), std::sin(turn_rad), 0.0);
    // A product of two equal profiles is the same after a quarter turn.
    const double quarter_rad = 0.5 * std::numbers::pi;
    planes.filter_turn_rad = std::remainder(std::atan2(axis.y, axis.x), quarter_rad);
    geometry.parameters.push_back(
        {"filter_turn_rad", planes.filter_turn_rad, radiometry.filter->turn_sigma_rad});
}

std::optional<PhotometerPlace> photometer_place(const capture::Plan& plan,
                                                const Geometry& geometry) {
    const ViewResult* on_s = first_view_on(geometry, TargetPlane::Screen);
    if (!plan.photometer || on_s == nullptr)
        return std::nullopt;
    const Rigid& camera_from_board = on_s->camera_from_board;
    const glm::dvec3 at_camera_m =
        camera_from_board.rotation * glm::dvec3(plan.photometer->on_screen_board_m, 0.0) +
        camera_from_board.translation_m;
    const std::optional<glm::dvec2> at_px = rig::project_px(geometry.lens, at_camera_m);
    if (!at_px)
        throw Error{"the photometer's place is not seen", "plan.photometer.on_screen_board_m",
                    "a point of S before the camera",
                    fmt::format("({}, {}) m", plan.photometer->on_screen_board_m.x,
                                plan.photometer->on_screen_board_m.y)};
    PhotometerPlace place;
    place.at_px = *at_px;
    place.view_angle_rad = std::acos(
        std::abs(glm::dot(camera_from_board.rotation[2], at_camera_m)) / glm::length(at_camera_m));
    place.reading_sigma_rel = plan.photometer->sigma_rel;
    return place;
}

void flag_geometry(const Geometry& geometry, std::vector<Flag>& flags) {
    for (const UnusedView& view : geometry.unused)
        flags.push_back({fmt::format("{} is not used: {}", view.name, view.why),
                         "take it again with all of the board in sight, sharp and evenly lit"});
    if (geometry.halves &&
        geometry.halves->difference_rms_px > 2 * geometry.halves->predicted_rms_px)
        flags.push_back(
            {fmt::format("two halves of the views disagree by {:.3f} px where {:.3f} are expected",
                         geometry.halves->difference_rms_px, geometry.halves->predicted_rms_px),
             "try another --lens-model, or a board that is known to be flat"});
    constexpr double kBent = 4;
    if (geometry.bend && geometry.bend->significance_sigma > kBent)
        flags.push_back(
            {fmt::format("the board is bent ({:.1f} sigma)", geometry.bend->significance_sigma),
             "use a stiffer board, or --bent-board"});
}

void collect(Calibration& calibration) {
    rig::Rig& rig = calibration.rig;
    if (calibration.geometry) {
        const Geometry& geometry = *calibration.geometry;
        rig.lens = geometry.lens;
        if (geometry.planes)
            rig.planes = geometry.planes->planes;
        rig.parameters = geometry.parameters;
        rig.covariance_of = geometry.covariance_of;
        rig.covariance = geometry.covariance;
        flag_geometry(geometry, calibration.flags);
    }
    if (calibration.radiometry) {
        RadiometryResult& radiometry = *calibration.radiometry;
        rig.radiometry = radiometry.radiometry;
        calibration.maps = radiometry.maps;
        rig.parameters.insert(rig.parameters.end(), radiometry.parameters.begin(),
                              radiometry.parameters.end());
        calibration.flags.insert(calibration.flags.end(), radiometry.flags.begin(),
                                 radiometry.flags.end());
    }
}

}  // namespace

Calibration calibrate_capture(const std::string& folder,
                              const capture::Capture& capture,
                              const CalibrationOptions& options) {
    const bool has_boards = holds(capture, ShotKind::Target);
    if (!has_boards && !tells_radiometry(capture))
        throw Error{"nothing to calibrate", folder,
                    "views of a target, darks and flats, or a bracket",
                    fmt::format("{} frames of other kinds", capture.frames.size())};
    const FrameReader read = reader_of(folder);
    const capture::Plan plan = capture.header.plan.value_or(capture::Plan{});
    RadiometryOptions radiometry_options = options_from(plan);
    radiometry_options.assumed_black_dn = options.assumed_black_dn;
    Calibration calibration;
    Observations observations;
    if (has_boards) {
        const double start_s = now_s();
        observations = observe(folder, capture, options);
        calibration.boards_s = now_s() - start_s;
    }
    if (tells_radiometry(capture))
        calibration.radiometry =
            calibrate_sensor(capture, read, radiometry_options, options.progress);
    if (has_boards) {
        if (calibration.radiometry)
            measure_filters(capture, options.geometry, read, observations, *calibration.radiometry);
        GeometryOptions geometry_options = options.geometry;
        geometry_options.with_planes =
            options.geometry.with_planes && (has_view_on(observations, TargetPlane::Screen) ||
                                             has_view_on(observations, TargetPlane::Filter));
        if (options.progress)
            options.progress("geometry", 0.0);
        calibration.geometry = calibrate_geometry(observations, geometry_options);
        if (calibration.radiometry && calibration.geometry->planes)
            set_filter_turn(*calibration.radiometry, *calibration.geometry);
    }
    if (calibration.radiometry)
        measure_scale(
            capture,
            calibration.geometry ? photometer_place(plan, *calibration.geometry) : std::nullopt,
            radiometry_options, read, options.progress, *calibration.radiometry);
    collect(calibration);
    return calibration;
}

}  // namespace nearfield::calibrate
