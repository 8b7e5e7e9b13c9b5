// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/plan_words.h"

#include <utility>

namespace nearfield::capture {
namespace {

Json camera_json(const CameraPlan& camera) {
    Json json = {{"device", camera.device},
                 {"pixel_format", camera.pixel_format},
                 {"gain_db", camera.gain_db},
                 {"packet_size_bytes", camera.packet_size_bytes},
                 {"byte_swap", camera.is_byte_swapped}};
    if (camera.region_size_px.x > 0)
        json["region_px"] = {camera.region_min_px.x, camera.region_min_px.y,
                             camera.region_size_px.x, camera.region_size_px.y};
    if (!camera.controls.empty())
        json["controls"] = camera.controls;
    if (camera.rgb_from_raw != glm::dmat3(1.0)) {
        Json numbers = Json::array();
        for (int k = 0; k < 9; ++k)
            numbers.push_back(camera.rgb_from_raw[k % 3][k / 3]);
        json["rgb_from_raw"] = std::move(numbers);
    }
    return json;
}

Json filter_json(const Plan& plan) {
    return {{"columns", plan.grid.x},
            {"rows", plan.grid.y},
            {"pitch_m", {plan.pitch_m.x, plan.pitch_m.y}},
            {"basis", plan.basis},
            {"peak", {plan.filter_peak.x, plan.filter_peak.y, plan.filter_peak.z}}};
}

Json with_exposure(Json json, double exposure_us) {
    if (exposure_us > 0)
        json["exposure_us"] = exposure_us;
    return json;
}

Json flats_json(const Plan& plan) {
    Json json = {{"count", plan.flats}};
    if (!plan.flat_exposures_us.empty())
        json["exposures_us"] = plan.flat_exposures_us;
    return json;
}

Json targets_json(const Plan& plan) {
    Json json;
    if (plan.board)
        json["board"] = json_of(*plan.board);
    json["views"] = Json::array();
    for (const TargetPlane view : plan.views)
        json["views"].push_back(word_for(kTargetPlanes, view));
    return with_exposure(std::move(json), plan.target_exposure_us);
}

Json filter_views_json(const FilterViewPlan& views) {
    Json positions = Json::array();
    for (const glm::ivec2 position : views.positions)
        positions.push_back({position.x, position.y});
    return with_exposure({{"positions", std::move(positions)}}, views.exposure_us);
}

Json screen_json(const ScreenPlan& screen) {
    Json factor = Json::array();
    for (std::size_t k = 0; k < screen.angle_deg.size(); ++k)
        factor.push_back({screen.angle_deg[k], screen.factor[k]});
    return {{"factor", std::move(factor)}};
}

Json photometer_json(const PhotometerPlan& photometer) {
    return {{"on_screen_board_m", {photometer.on_screen_board_m.x, photometer.on_screen_board_m.y}},
            {"correction", photometer.correction},
            {"sigma_rel", photometer.sigma_rel},
            {"mismatch_rel", photometer.mismatch_rel}};
}

}  // namespace

Json json_of(const Plan& plan) {
    Json document = {{"nearfield_plan", kPlanVersion},
                     {"camera", camera_json(plan.camera)},
                     {"stage", word_for(kStages, plan.stage)}};
    if (!plan.instruments.empty())
        document["instruments"] = json_of(plan.instruments);
    if (plan.grid.x > 0)
        document["filter"] = filter_json(plan);
    if (!plan.filter_views.positions.empty())
        document["filter_views"] = filter_views_json(plan.filter_views);
    if (!plan.bracket.exposures_us.empty())
        document["exposures_us"] = plan.bracket.exposures_us;
    document["bracket"] = {{"least_us", plan.bracket.least_us},
                           {"most_us", plan.bracket.most_us},
                           {"darkest_share", plan.bracket.darkest_share}};
    document["repeats"] = plan.repeats;
    document["darks_per_exposure"] = plan.darks;
    document["darks_after_per_exposure"] = plan.darks_after;
    document["blocked_per_exposure"] = plan.blocked;
    document["flats"] = flats_json(plan);
    document["targets"] = targets_json(plan);
    if (!plan.screen.angle_deg.empty())
        document["screen"] = screen_json(plan.screen);
    if (plan.photometer)
        document["photometer"] = photometer_json(*plan.photometer);
    document["drift"] = {{"every", plan.drift_every}, {"limit_rel", plan.drift_limit_rel}};
    document["exposure_ratio_limit_rel"] = plan.ratio_limit_rel;
    document["settle_s"] = plan.settle_s;
    return document;
}

}  // namespace nearfield::capture
