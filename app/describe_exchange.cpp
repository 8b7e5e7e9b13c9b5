// SPDX-License-Identifier: Apache-2.0
#include "app/describe_exchange.h"

#include "formats/photometry/intensity.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nearfield::app {
namespace {

using nlohmann::ordered_json;

constexpr double kMmInM = 1e3;

const char* unit_of(const rays::RaySurvey& survey) {
    return survey.quantity == Quantity::Photometric ? "lm" : "W";
}

ordered_json in_mm(const glm::dvec3& p_m) {
    return {kMmInM * p_m.x, kMmInM * p_m.y, kMmInM * p_m.z};
}

const char* type_of(photometry::Coordinates coordinates) {
    return coordinates == photometry::Coordinates::C   ? "C"
           : coordinates == photometry::Coordinates::B ? "B"
                                                       : "A";
}

const char* name_of(photometry::Shape shape) {
    using photometry::Shape;
    switch (shape) {
        case Shape::Point:
            return "point";
        case Shape::Rectangle:
            return "rectangle";
        case Shape::Ellipse:
            return "ellipse";
        case Shape::CylinderX:
            return "cylinder along x";
        case Shape::CylinderY:
            return "cylinder along y";
        case Shape::Ellipsoid:
            return "ellipsoid";
        case Shape::UprightEllipse:
            return "ellipse that faces x";
    }
    return "";
}

std::string notes_text(const std::vector<std::string>& notes) {
    std::string text;
    for (const std::string& note : notes)
        text += fmt::format("note       {}\n", note);
    return text;
}

}  // namespace

ordered_json describe(const rays::RaySurvey& survey) {
    ordered_json json = {
        {"kind", "ray file"},
        {"format", survey.format},
        {"quantity", survey.quantity == Quantity::Photometric ? "photometric" : "radiometric"},
        {"rays", survey.rays},
        {"flux",
         {{"of_rays", survey.flux},
          {"stated", survey.flux_stated},
          {"backward", survey.backward_flux},
          {"unit", unit_of(survey)}}},
        {"backward_rays", survey.backward_rays},
        {"start_mm", {in_mm(survey.least_start_m), in_mm(survey.most_start_m)}}};
    json["focus_mm"] = survey.focus_m ? in_mm(*survey.focus_m) : ordered_json(nullptr);
    json["notes"] = survey.notes;
    return json;
}

ordered_json describe(const photometry::Photometry& lamp) {
    const photometry::Peak peak = photometry::peak(lamp);
    ordered_json json = {
        {"kind", "photometry"},
        {"format", lamp.format},
        {"type", type_of(lamp.coordinates)},
        {"planes", {lamp.planes_deg.size(), lamp.planes_deg.front(), lamp.planes_deg.back()}},
        {"angles", {lamp.angles_deg.size(), lamp.angles_deg.front(), lamp.angles_deg.back()}},
        {"is_absolute", lamp.is_absolute},
        {"flux_lm", photometry::flux_lm(lamp)},
        {"peak",
         {{"intensity_cd", peak.intensity_cd},
          {"plane_deg", peak.angles.plane_deg},
          {"angle_deg", peak.angles.angle_deg}}},
        {"opening",
         {{"shape", name_of(lamp.opening.shape)}, {"size_mm", in_mm(lamp.opening.size_m)}}}};
    json["lamps"] = ordered_json::array();
    for (const photometry::LampSet& lamps : lamp.lamps)
        json["lamps"].push_back({{"count", lamps.count},
                                 {"type", lamps.type},
                                 {"flux_lm", lamps.flux_lm},
                                 {"input_w", lamps.input_w}});
    json["labels"] = ordered_json::array();
    for (const auto& [keyword, text] : lamp.labels)
        json["labels"].push_back({keyword, text});
    json["notes"] = lamp.notes;
    return json;
}

std::string rays_text(const rays::RaySurvey& survey) {
    const char* u = unit_of(survey);
    std::string text = fmt::format("kind       ray file, {}\nrays       {}\nflux       {:.6g} {}",
                                   survey.format, survey.rays, survey.flux, u);
    text += survey.flux_stated > 0 ? fmt::format(", {:.6g} {} stated\n", survey.flux_stated, u)
                                   : std::string(", none stated\n");
    text += fmt::format("backwards  {} rays, {:.4g} {} ({:.3g} %)\n", survey.backward_rays,
                        survey.backward_flux, u, 100 * survey.backward_flux / survey.flux);
    const glm::dvec3 least_mm = kMmInM * survey.least_start_m;
    const glm::dvec3 most_mm = kMmInM * survey.most_start_m;
    text +=
        fmt::format("starts     x {:.4f} ... {:.4f}, y {:.4f} ... {:.4f}, z {:.4f} ... {:.4f} mm\n",
                    least_mm.x, most_mm.x, least_mm.y, most_mm.y, least_mm.z, most_mm.z);
    if (survey.focus_m) {
        const glm::dvec3 focus_mm = kMmInM * *survey.focus_m;
        text +=
            fmt::format("focus      ({:.4f}, {:.4f}, {:.4f}) mm: the point nearest to all rays\n",
                        focus_mm.x, focus_mm.y, focus_mm.z);
    }
    return text + notes_text(survey.notes);
}

std::string photometry_text(const photometry::Photometry& lamp) {
    const photometry::Peak peak = photometry::peak(lamp);
    std::string text = fmt::format(
        "kind       photometry, {}, type {}, {}\n"
        "table      {} planes {:g} ... {:g} deg, {} angles {:g} ... {:g} deg, unfolded\n"
        "flux       {:.6g} lm\n"
        "peak       {:.6g} cd in plane {:g}, angle {:g} deg\n"
        "opening    {}, {:g} x {:g} x {:g} mm\n",
        lamp.format, type_of(lamp.coordinates), lamp.is_absolute ? "absolute" : "relative",
        lamp.planes_deg.size(), lamp.planes_deg.front(), lamp.planes_deg.back(),
        lamp.angles_deg.size(), lamp.angles_deg.front(), lamp.angles_deg.back(),
        photometry::flux_lm(lamp), peak.intensity_cd, peak.angles.plane_deg, peak.angles.angle_deg,
        name_of(lamp.opening.shape), kMmInM * lamp.opening.size_m.x, kMmInM * lamp.opening.size_m.y,
        kMmInM * lamp.opening.size_m.z);
    for (std::size_t k = 0; k < lamp.lamps.size(); ++k)
        text += fmt::format(
            "lamps {}    {} x {}, {:g} lm in all, {:g} W{}\n", k, lamp.lamps[k].count,
            lamp.lamps[k].type.empty() ? "?" : lamp.lamps[k].type, lamp.lamps[k].flux_lm,
            lamp.lamps[k].input_w, static_cast<int>(k) == lamp.lamp_set ? ", the table's" : "");
    for (const auto& [keyword, value] : lamp.labels)
        text += fmt::format("  {:<24} {}\n", keyword, value);
    return text + notes_text(lamp.notes);
}

}  // namespace nearfield::app
