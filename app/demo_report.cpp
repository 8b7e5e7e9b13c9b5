// SPDX-License-Identifier: Apache-2.0
#include "app/demo.h"
#include "app/output.h"
#include "formats/files/atomic_file.h"
#include "formats/report/plot.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace nearfield::app {
namespace {

constexpr double kMapDistance_m = 10.0;
constexpr const char* kNoGnuplot =
    "gnuplot is not installed or failed, so the plots of this section are missing (Debian package "
    "gnuplot-nox).";

std::string percent(double share) {
    return fmt::format("{:.2g} %", 100.0 * share);
}

void add_plot(report::Section& section, const std::optional<report::Image>& image) {
    if (image) {
        section.images.push_back(*image);
    } else if (section.paragraphs.empty() || section.paragraphs.back() != kNoGnuplot) {
        section.paragraphs.emplace_back(kNoGnuplot);
    }
}

report::Section about() {
    return {
        "What this is",
        {"A synthetic low beam for right-hand traffic, whose radiance is a formula, was projected "
         "onto a light field luminaire: one image per basis function on its lens. Two such lamps, "
         "0.65 m above the road and 1.2 m apart, light a scene: every pixel's irradiance is the "
         "exact sum over all images, its shadows are traced.",
         "To see: the cut-off line with its 15 degree kink on the wall, its blue fringe above and "
         "its warm one below; light and color on the road close to the lamps; shadows that get "
         "softer away from what casts them."},
        {},
        {},
        {}};
}

report::Section pictures(const DemoOptions& options, const DemoResult& result) {
    report::Section section{"The picture", {}, {}, {}, {}};
    for (const DemoView& view : result.views) {
        section.images.push_back(
            report::read_image(path_in(options, view.png),
                               fmt::format("Camera \"{}\"; filmic tone curve, exposure {:.2f} EV",
                                           view.camera, view.exposure_ev)));
    }
    return section;
}

report::Section lamp(const DemoOptions& options, const DemoResult& result) {
    const Slab& slab = result.lamp.lightfield.slabs.front();
    report::Section section{"The lamp", {}, {}, {}, {}};
    section.paragraphs.push_back(
        fmt::format("{} x {} images of {} x {} texels, {} basis, planes {:g} m apart; {:.1f} lm.",
                    slab.grid.x, slab.grid.y, slab.texels.x, slab.texels.y, slab.profile.name,
                    slab.delta_m, result.lamp.figures.flux_lm));
    section.images.push_back(report::read_image(
        path_in(options, "lamp_images.png"),
        "The images C_m as seen from the lamp's front, cube-root scale: each is what one spot of "
        "the lens sends to the plane ahead of it."));
    section.images.push_back(report::read_image(
        path_in(options, "lamp_seen.png"),
        "The lens as seen from afar, each column as bright as its brightest point; above: the "
        "formula, below: the "
        "light field. From the left: from the hot spot, from above the cut-off, from the kink's "
        "side, from far left, from the road."));
    return section;
}

report::HeatMap wall_map(const DemoResult& result) {
    const glm::ivec2 points(160, 56);
    const std::vector<sample_data::WallPoint> wall = sample_data::wall_points(
        result.lamp.headlight, result.lamp.lightfield, kMapDistance_m, points);
    report::HeatMap map;
    map.title = fmt::format("Illuminance on a wall {:g} m from one lamp", kMapDistance_m);
    map.x_label = "x, m (to the driver's left; drawn as the driver sees it)";
    map.y_label = "y above the lamp, m";
    map.value_label = "lx";
    map.lower = wall.front().at_m;
    map.upper = wall.back().at_m;
    map.size = points;
    for (const sample_data::WallPoint& point : wall) {
        map.values.push_back(point.lightfield_lx);
        map.high = std::max(map.high, point.lightfield_lx);
    }
    map.low = map.high / 1000.0;
    map.log_scale = true;
    map.flip_x = true;
    return map;
}

report::Plot profile_plot(const DemoResult& result) {
    report::Plot plot;
    plot.title = "Across the cut-off, 3 degrees left: illuminance times distance squared";
    plot.x_label = "height above the lamp over distance (tangent)";
    plot.y_label = "E d^2, cd";
    plot.log_y = true;
    for (const double distance_m : {1.0, 3.0, 10.0, 25.0}) {
        report::Curve light{fmt::format("light field, {:g} m", distance_m), {}, {}};
        report::Curve truth{fmt::format("formula, {:g} m", distance_m), {}, {}};
        for (const sample_data::WallPoint& point : sample_data::wall_profile(
                 result.lamp.headlight, result.lamp.lightfield, distance_m, 0.0524, 240)) {
            const double square_m2 = distance_m * distance_m;
            light.x.push_back(point.at_m.y / distance_m);
            light.y.push_back(point.lightfield_lx * square_m2);
            truth.x.push_back(point.at_m.y / distance_m);
            truth.y.push_back(point.truth_lx * square_m2);
        }
        plot.curves.push_back(std::move(truth));
        plot.curves.push_back(std::move(light));
    }
    return plot;
}

report::Section wall(const DemoResult& result) {
    report::Section section{"Light on a wall", {}, {}, {}, {}};
    add_plot(section, report::draw(wall_map(result), "Illuminance in false color, logarithmic."));
    add_plot(section,
             report::draw(profile_plot(result),
                          "Vertical profiles through the cut-off. Near the lamp the curves differ: "
                          "there, it is no point source."));
    return section;
}

report::Section truth(const DemoResult& result) {
    report::Section section{"Formula against light field", {}, {}, {}, {}};
    section.paragraphs.emplace_back(
        "The representation error: what this light field misses of the lamp's formula, by "
        "quadrature of the formula on walls without shadows. Relative to each point where it is "
        "brighter than 1e-3 of "
        "the brightest; the last column is the largest difference relative to the brightest "
        "point.");
    report::Table table{
        "Illuminance",
        {"wall at", "brightest", "median", "95 % below", "mean error", "largest, of peak"},
        {}};
    for (const sample_data::WallError& error : result.lamp.walls) {
        table.rows.push_back({fmt::format("{:g} m", error.distance_m),
                              fmt::format("{:.4g} lx", error.peak_lx), percent(error.median_rel),
                              percent(error.p95_rel), percent(error.bias_rel),
                              percent(error.max_of_peak)});
    }
    section.tables.push_back(table);
    report::Table figures{"What the projection says of itself", {"figure", "value"}, {}};
    for (const auto& [name, value] : result.lamp.lightfield.provenance.figures) {
        figures.rows.push_back({name, fmt::format("{:.6g}", value)});
    }
    section.tables.push_back(figures);
    return section;
}

report::Section cost_section(const DemoResult& result) {
    report::Section section{"Stages", {}, {}, {}, {}};
    report::Table table{"Time, memory (of the process, at most so far) and error estimate",
                        {"stage", "time", "memory", "error estimate"},
                        {}};
    for (const Stage& stage : result.stages) {
        table.rows.push_back({stage.name, fmt::format("{:.2f} s", stage.time_s),
                              fmt::format("{:.0f} MiB", stage.peak_memory_mib),
                              stage.error_estimate});
    }
    section.tables.push_back(table);
    return section;
}

report::Section provenance(const DemoResult& result, const std::string& command_line) {
    report::Section section{"Provenance", {}, {}, {}, {}};
    section.preformatted = fmt::format("{}\n{}\n{}\n", command_line, program_version(), machine());
    report::Table options{"Options of the lamp", {"option", "value"}, {}};
    for (const auto& [name, value] : result.lamp.lightfield.provenance.options) {
        options.rows.push_back({name, value});
    }
    section.tables.push_back(options);
    return section;
}

nlohmann::ordered_json to_json(const DemoResult& result, const std::string& command_line) {
    nlohmann::ordered_json json;
    json["kind"] = "demo_report";
    json["program"] = program_version();
    json["command"] = command_line;
    json["machine"] = machine();
    json["files"] = result.files;
    for (const Stage& stage : result.stages) {
        json["stages"].push_back({{"name", stage.name},
                                  {"time_s", stage.time_s},
                                  {"peak_memory_mib", stage.peak_memory_mib},
                                  {"error_estimate", stage.error_estimate}});
    }
    for (const auto& [name, value] : result.lamp.lightfield.provenance.figures) {
        json["figures"][name] = value;
    }
    for (const DemoView& view : result.views) {
        json["views"].push_back(
            {{"camera", view.camera},
             {"png", view.png},
             {"time_s", view.time_s},
             {"exposure_ev", view.exposure_ev},
             {"sigma_mean_rel", view.report.sampling.mean_rel},
             {"sigma_p95_rel", view.report.sampling.p95_rel},
             {"sigma_share_above_10_percent", view.report.sampling.share_above_10_percent}});
    }
    return json;
}

}  // namespace

void write_demo_report(const DemoOptions& options,
                       const DemoResult& result,
                       const std::string& command_line) {
    report::Page page;
    page.title = "Two headlights on a road";
    page.summary = "Made by " + program_version() +
                   ": from a lamp's radiance to a picture, with errors and costs.";
    page.sections = {
        about(),       pictures(options, result), lamp(options, result),           wall(result),
        truth(result), cost_section(result),      provenance(result, command_line)};
    report::write_page(page, path_in(options, "report.html"));
    write_file(to_json(result, command_line).dump(2) + "\n", path_in(options, "report.json"));
}

}  // namespace nearfield::app
