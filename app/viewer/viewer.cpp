// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/viewer.h"

#include "formats/files/error.h"
#include "formats/files/image.h"
#include "formats/shared/tonemap.glsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::viewer {
namespace {

constexpr std::size_t kMostShots = 120;

glm::ivec2 pixel_at(const Frame& frame, glm::dvec2 at) {
    return glm::clamp(glm::ivec2(at * glm::dvec2(frame.size_px)), glm::ivec2(0), frame.size_px - 1);
}

void add_shot(Viewer& viewer) {
    viewer.shots.push_back(
        {viewer.frame->time_s, viewer.frame->knows_error()
                                   ? std::optional(error_of(*viewer.frame, viewer.mixed))
                                   : std::nullopt});
    if (viewer.shots.size() > kMostShots)
        viewer.shots.pop_front();
}

void develop_all(Viewer& viewer) {
    const Frame& frame = *viewer.frame;
    viewer.mixed = mix(frame, gains_of(frame, viewer.history.now, viewer.solo));
    viewer.developed = develop(frame, viewer.mixed, viewer.look);
    viewer.difference.reset();
    if (!viewer.kept)
        return;
    const KeptState& kept = *viewer.kept;
    if (kept.mixed.size_px == viewer.mixed.size_px)
        viewer.difference = difference_of(viewer.mixed, kept.mixed);
    Look look = viewer.look;
    look.display.exposure_ev = viewer.developed.exposure_ev;  // one exposure for both
    const Developed left = develop(*kept.frame, kept.mixed, look);
    const double exposure_ev = viewer.developed.exposure_ev;
    viewer.developed = beside(
        left, viewer.shows_map && viewer.difference ? viewer.difference->map : viewer.developed,
        viewer.split);
    viewer.developed.exposure_ev = exposure_ev;
}

}  // namespace

void take(Viewer& viewer, Opened opened) {
    const bool is_same_file = viewer.is_open && !opened.document.path.empty() &&
                              opened.document.path == viewer.history.now.path;
    const int next_id = viewer.history.now.next_id;
    if (is_same_file)
        opened.document.next_id = std::max(opened.document.next_id, next_id);
    viewer.history = {std::move(opened.document), {}, {}, 0};
    const Document& document = viewer.history.now;
    viewer.saved_changes = viewer.autosaved_changes = ++viewer.changes;
    viewer.selected =
        document.lamps.empty() ? std::nullopt : std::optional(document.lamps.front().id);
    viewer.solo.reset();
    viewer.drag.reset();
    viewer.kept.reset();
    if (!is_same_file)
        viewer.view = document.scene->cameras.empty() ? drivers_view(document)
                                                      : View{document.scene->cameras.front(), 6.0};
    viewer.is_open = viewer.is_stale = true;
    viewer.message = opened.notes.empty() ? "" : opened.notes.front();
}

void change(Viewer& viewer, const Edit& made, int gesture) {
    const std::size_t lamps_before = viewer.history.now.lamps.size();
    edit(viewer.history, made, gesture);
    ++viewer.changes;
    const std::vector<EditedLamp>& lamps = viewer.history.now.lamps;
    if (lamps.size() > lamps_before)
        viewer.selected = lamps.back().id;
    viewer.is_stale = true;
}

void undo(Viewer& viewer) {
    if (undo(viewer.history)) {
        ++viewer.changes;
        viewer.is_stale = true;
    }
}

void redo(Viewer& viewer) {
    if (redo(viewer.history)) {
        ++viewer.changes;
        viewer.is_stale = true;
    }
}

int begin_gesture(Viewer& viewer) {
    return ++viewer.gesture;
}

bool is_unsaved(const Viewer& viewer) {
    return viewer.changes != viewer.saved_changes;
}

void save(Viewer& viewer, const std::string& path) {
    viewer.history.now = save_document(viewer.history.now, path);
    viewer.saved_changes = viewer.autosaved_changes = viewer.changes;
    viewer.message = fmt::format("saved {}", path);
}

void keep_state(Viewer& viewer) {
    if (!viewer.frame)
        return;
    viewer.kept = KeptState{"what was kept", viewer.frame, viewer.mixed};
    viewer.is_stale = true;
}

void compare_with(Viewer& viewer, const std::string& path) {
    Picture picture = read_picture(path);
    const auto layer = [&](const std::string& name, std::size_t channels) {
        const auto found = std::find_if(
            picture.layers.begin(), picture.layers.end(),
            [&](const Layer& one) { return one.name == name && one.channels.size() == channels; });
        return found == picture.layers.end() ? std::vector<float>() : std::move(found->values);
    };
    const auto pixels = static_cast<std::size_t>(picture.size_px.x * picture.size_px.y);
    Frame frame;
    frame.size_px = picture.size_px;
    frame.depth_m = layer("depth", 1);
    frame.depth_m.resize(pixels, 1.0F);
    Mixed mixed{picture.size_px, layer("", 3), layer("irradiance", 3), layer("sigma", 1),
                layer("bias_bound", 1)};
    if (mixed.radiance.empty())
        throw Error{"cannot compare", path, "channels R, G and B", "none of that name"};
    mixed.irradiance.resize(3 * pixels);
    mixed.sigma.resize(pixels);
    mixed.bias.resize(pixels);
    viewer.kept =
        KeptState{path, std::make_shared<const Frame>(std::move(frame)), std::move(mixed)};
    viewer.is_stale = true;
    viewer.message.clear();
}

Request request_of(const Viewer& viewer, glm::ivec2 size_px) {
    return {viewer.history.now, viewer.view.camera, size_px, viewer.dial, viewer.serial};
}

const std::string& said(const Viewer& viewer) {
    return viewer.progress.error.empty() ? viewer.message : viewer.progress.error;
}

double error_of(const Frame& frame, const Mixed& mixed) {
    Layer depth{"depth", {"Z"}, frame.depth_m};  // 0 where a pixel does not count
    for (const std::shared_ptr<const LampLight>& light : frame.lamps)
        for (std::size_t k = 0; k < light->seen.size(); ++k)
            if (light->seen[k] > 0.0F)
                depth.values[k / 3] = 0.0F;
    const Layer radiance{"", {"R", "G", "B"}, mixed.radiance};
    const Layer sigma{"sigma", {"Y"}, mixed.sigma}, bias{"bias", {"Y"}, mixed.bias};
    return render::summarize_noise(radiance, sigma, &bias, &depth).error_rel();
}

bool refresh(Viewer& viewer, const Progress& progress) {
    const bool is_new_frame = progress.frame != viewer.frame;
    viewer.progress = progress;
    if (!progress.frame || (!is_new_frame && !viewer.is_stale))
        return false;
    viewer.frame = progress.frame;
    viewer.is_stale = false;
    develop_all(viewer);
    if (is_new_frame)
        add_shot(viewer);
    return true;
}

std::optional<Reading> reading_under_mouse(const Viewer& viewer) {
    if (!viewer.frame || !viewer.mouse)
        return std::nullopt;
    Reading reading =
        reading_at(*viewer.frame, viewer.mixed, pixel_at(*viewer.frame, *viewer.mouse));
    return reading.depth_m > 0.0 ? std::optional(reading) : std::nullopt;
}

std::optional<glm::dvec3> surface_at(const Viewer& viewer, glm::dvec2 at) {
    if (!viewer.frame)
        return std::nullopt;
    const Reading reading = reading_at(*viewer.frame, viewer.mixed, pixel_at(*viewer.frame, at));
    return reading.depth_m > 0.0 ? std::optional(reading.position_world_m) : std::nullopt;
}

std::optional<RegionStatistics> region_statistics(const Viewer& viewer) {
    if (!viewer.frame || !viewer.region)
        return std::nullopt;
    return statistics_of(*viewer.frame, viewer.mixed, pixel_at(*viewer.frame, viewer.region->first),
                         pixel_at(*viewer.frame, viewer.region->second));
}

}  // namespace nearfield::viewer
