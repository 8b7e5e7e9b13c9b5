// SPDX-License-Identifier: Apache-2.0
#include "formats/files/metadata.h"

#include "formats/files/error.h"
#include "formats/files/json_field.h"

#include <fmt/format.h>

#include <cmath>

namespace nearfield {
namespace {

// Beyond these a file cannot be right, and sizes computed from them fit in 64 bits.
constexpr double kMostCoefficients = 0x1p40;  // 4 TiB of floats
constexpr int kMaxExtent = 1 << 20;
constexpr int kMaxSlabs = 1024;
constexpr int kMaxProfileCells = 1024;

Json pair(glm::dvec2 v) {
    return Json::array({v.x, v.y});
}
Json pair(glm::ivec2 v) {
    return Json::array({v.x, v.y});
}

glm::dvec2 read_pair(const JsonField& field) {
    const std::vector<double> v = field.numbers(2);
    return {v[0], v[1]};
}

glm::ivec2 read_sizes(const JsonField& field) {
    const std::vector<JsonField> v = field.elements(2);
    return {v[0].integer(1, kMaxExtent), v[1].integer(1, kMaxExtent)};
}

// A text that stands for one of two values.
template <typename Value>
Value read_choice(const JsonField& field,
                  const std::pair<std::string, Value>& a,
                  const std::pair<std::string, Value>& b) {
    const std::string text = field.text();
    if (text == a.first)
        return a.second;
    if (text == b.first)
        return b.second;
    throw Error{"bad metadata", field.where(), a.first + " or " + b.first, "'" + text + "'"};
}

std::string coeffs_unit(Quantity quantity, Weighting weighting) {
    const bool is_photometric = quantity == Quantity::Photometric;
    if (weighting == Weighting::Irradiance)
        return is_photometric ? "lm m^-4" : "W m^-4";
    return is_photometric ? "cd m^-2" : "W m^-2 sr^-1";
}

Json describe_pose(const Rigid& pose) {
    Json rotation = Json::array();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            rotation.push_back(pose.rotation[column][row]);
    const glm::dvec3& t = pose.translation_m;
    return {{"rotation", rotation}, {"translation_m", Json::array({t.x, t.y, t.z})}};
}

Rigid parse_pose(const JsonField& field) {
    Rigid pose;
    const std::vector<double> r = field.at("rotation").numbers(9);
    for (int k = 0; k < 9; ++k)
        pose.rotation[k % 3][k / 3] = r[static_cast<std::size_t>(k)];
    const std::vector<double> t = field.at("translation_m").numbers(3);
    pose.translation_m = {t[0], t[1], t[2]};
    return pose;
}

Json describe_slab(const Slab& slab, Quantity quantity) {
    Json cells = Json::array();
    for (const std::array<double, 3>& cell : slab.profile.cells)
        cells.push_back(cell);
    Json description = {
        {"luminaire_from_slab", describe_pose(slab.luminaire_from_slab)},
        {"delta_m", slab.delta_m},
        {"grid", pair(slab.grid)},
        {"pitch_m", pair(slab.pitch_m)},
        {"u_center_m", pair(slab.u_center_m)},
        {"texels", pair(slab.texels)},
        {"s_min_m", pair(slab.s_min_m)},
        {"s_max_m", pair(slab.s_max_m)},
        {"basis", slab.profile.name},
        {"profile_cells", cells},
        {"weighting", slab.weighting == Weighting::Irradiance ? "irradiance" : "radiance"},
        {"channels", slab.channels == 3 ? Json::array({"R", "G", "B"}) : Json::array({"Y"})},
        {"coeffs_unit", coeffs_unit(quantity, slab.weighting)},
        {"has_sigma", !slab.sigma.empty()}};
    if (!slab.replicates.empty())
        description["replicates"] = slab.replicates.size();
    return description;
}

int parse_channels(const JsonField& field) {
    std::string names;
    for (const JsonField& name : field.elements())
        names += name.text();
    if (names != "RGB" && names != "Y")
        throw Error{"bad metadata", field.where(), "[\"R\", \"G\", \"B\"] or [\"Y\"]", names};
    return names == "Y" ? 1 : 3;
}

Slab parse_slab(const JsonField& field) {
    Slab slab;
    slab.luminaire_from_slab = parse_pose(field.at("luminaire_from_slab"));
    slab.delta_m = field.at("delta_m").number();
    slab.grid = read_sizes(field.at("grid"));
    slab.pitch_m = read_pair(field.at("pitch_m"));
    slab.u_center_m = read_pair(field.at("u_center_m"));
    slab.texels = read_sizes(field.at("texels"));
    slab.s_min_m = read_pair(field.at("s_min_m"));
    slab.s_max_m = read_pair(field.at("s_max_m"));
    slab.profile.name = field.at("basis").text();
    for (const JsonField& cell : field.at("profile_cells").elements()) {
        const std::vector<double> a = cell.numbers(3);
        slab.profile.cells.push_back({a[0], a[1], a[2]});
    }
    slab.weighting =
        read_choice<Weighting>(field.at("weighting"), {"irradiance", Weighting::Irradiance},
                               {"radiance", Weighting::Radiance});
    slab.channels = parse_channels(field.at("channels"));
    return slab;
}

std::string text(glm::dvec2 v) {
    return fmt::format("({}, {})", v.x, v.y);
}

void check_rotation(const glm::dmat3& rotation, const std::string& where) {
    // A rotation typed by hand with seven digits passes, a scaled or mirrored one does not.
    constexpr double kTolerance = 1e-6;
    const glm::dmat3 product = glm::transpose(rotation) * rotation;
    double worst = std::abs(glm::determinant(rotation) - 1.0);
    for (int k = 0; k < 9; ++k)
        worst = std::max(worst, std::abs(product[k / 3][k % 3] - (k % 4 == 0 ? 1.0 : 0.0)));
    if (!(worst <= kTolerance))
        throw Error{"bad slab", where + ".luminaire_from_slab.rotation",
                    "a proper rotation (determinant +1)", fmt::format("off by {:.3g}", worst)};
}

}  // namespace

namespace {

// Lengths of any lamp: beyond these, products of lengths leave the range of float.
constexpr double kLeastLengthM = 1e-9, kGreatestLengthM = 1e9;

bool is_length(double value) {
    return value >= kLeastLengthM && value <= kGreatestLengthM;
}

bool is_place(glm::dvec2 value) {
    return std::abs(value.x) <= kGreatestLengthM && std::abs(value.y) <= kGreatestLengthM;
}

// phi >= 0 (but for rounding) at the ends and the vertex of every cell, and somewhere > 0: samplers
// and fluxes rely on it.
bool is_density(const Profile& profile) {
    constexpr double kRounding = 1e-9;
    const auto n = static_cast<double>(profile.cells.size());
    double least = 0.0, greatest = 0.0;
    for (std::size_t c = 0; c < profile.cells.size(); ++c) {
        const auto& [a0, a1, a2] = profile.cells[c];
        const double lo = static_cast<double>(c) - 0.5 * n, hi = lo + 1.0;
        const double vertex = a2 != 0.0 ? std::clamp(-0.5 * a1 / a2, lo, hi) : lo;
        for (const double x : {lo, hi, vertex}) {
            const double phi = a0 + x * (a1 + x * a2);
            least = std::min(least, phi);
            greatest = std::max(greatest, phi);
        }
    }
    return greatest > 0.0 && least >= -kRounding * greatest;
}

}  // namespace

void check_geometry(const Slab& slab, const std::string& where) {
    const auto require = [&](bool ok, const char* field, const std::string& expected,
                             const std::string& got) {
        if (!ok)
            throw Error{"bad slab", where + "." + field, expected, got};
    };
    const glm::dvec3& t = slab.luminaire_from_slab.translation_m;
    require(is_place({t.x, t.y}) && is_place({t.z, 0.0}), "luminaire_from_slab.translation_m",
            "numbers from -1e9 to 1e9", fmt::format("({}, {}, {})", t.x, t.y, t.z));
    check_rotation(slab.luminaire_from_slab.rotation, where);
    require(is_length(slab.delta_m), "delta_m", "a number from 1e-9 to 1e9",
            fmt::format("{}", slab.delta_m));
    require(is_length(slab.pitch_m.x) && is_length(slab.pitch_m.y), "pitch_m",
            "numbers from 1e-9 to 1e9", text(slab.pitch_m));
    require(is_place(slab.u_center_m), "u_center_m", "numbers from -1e9 to 1e9",
            text(slab.u_center_m));
    const glm::dvec2 extent = slab.s_max_m - slab.s_min_m;
    require(is_place(slab.s_min_m) && is_place(slab.s_max_m) && is_length(extent.x) &&
                is_length(extent.y),
            "s_max_m",
            "numbers up to 1e9, by 1e-9 or more greater than s_min_m " + text(slab.s_min_m),
            text(slab.s_max_m));
    for (const auto& [size, field] : {std::pair{slab.grid, "grid"}, {slab.texels, "texels"}})
        require(std::min(size.x, size.y) >= 1 && std::max(size.x, size.y) <= kMaxExtent, field,
                "sizes from 1 to 1048576", text(size));
    require(slab.channels == 1 || slab.channels == 3, "channels", "1 or 3",
            std::to_string(slab.channels));
    const std::size_t cell_count = slab.profile.cells.size();
    require(cell_count >= 1 && cell_count <= kMaxProfileCells, "profile_cells", "1 to 1024 cells",
            std::to_string(cell_count));
    for (const std::array<double, 3>& cell : slab.profile.cells)
        for (const double a : cell)
            require(std::isfinite(a), "profile_cells", "finite numbers", fmt::format("{}", a));
    require(is_density(slab.profile), "profile_cells",
            "a profile >= 0 everywhere and > 0 somewhere", "one that is not");
    const double coefficients = static_cast<double>(slab.grid.x) * slab.grid.y * slab.texels.x *
                                slab.texels.y * slab.channels;
    require(coefficients <= kMostCoefficients, "texels",
            fmt::format("at most {:g} coefficients in all", kMostCoefficients),
            fmt::format("{:g}", coefficients));
}

std::string describe(const LightField& lightfield, const FileKind& kind, bool has_tables) {
    Json slabs = Json::array();
    for (const Slab& slab : lightfield.slabs)
        slabs.push_back(describe_slab(slab, lightfield.quantity));
    Json document = {
        {"kind", kind.kind},
        {"format_version", kind.format_version},
        {"quantity", lightfield.quantity == Quantity::Photometric ? "photometric" : "radiometric"},
        {"scale_sigma_rel", lightfield.scale_sigma_rel}};
    if (kind.kind == "luminaire")
        document["has_tables"] = has_tables;
    document["slabs"] = slabs;
    return json_text(document);
}

namespace {

FileKind parse_kind(const JsonField& root) {
    FileKind kind;
    kind.kind = root.at("kind").text();
    if (kind.kind != "lightfield" && kind.kind != "luminaire")
        throw Error{"unknown kind of file", root.where(), "lightfield or luminaire",
                    "'" + kind.kind + "'"};
    constexpr int kAnyVersion = 1 << 30;
    kind.format_version = root.at("format_version").integer(1, kAnyVersion);
    if (kind.format_version > kFormatVersion)
        throw Error{"file is newer than this program", root.where() + ".format_version",
                    fmt::format("at most {}", kFormatVersion), std::to_string(kind.format_version)};
    return kind;
}

}  // namespace

FileKind parse_kind(const std::string& text, const std::string& where) {
    const Json document = parse_json(text, where);
    return parse_kind(JsonField(document, where));
}

Description parse_description(const std::string& text, const std::string& where) {
    const Json document = parse_json(text, where);
    const JsonField root(document, where);
    Description description;
    description.kind = parse_kind(root);
    LightField& lightfield = description.lightfield;
    lightfield.quantity =
        read_choice<Quantity>(root.at("quantity"), {"photometric", Quantity::Photometric},
                              {"radiometric", Quantity::Radiometric});
    lightfield.scale_sigma_rel = root.at("scale_sigma_rel").number();
    const std::vector<JsonField> slabs = root.at("slabs").elements();
    if (slabs.empty() || slabs.size() > kMaxSlabs)
        throw Error{"bad metadata", root.at("slabs").where(), "1 to 1024 slabs",
                    std::to_string(slabs.size())};
    for (std::size_t k = 0; k < slabs.size(); ++k) {
        lightfield.slabs.push_back(parse_slab(slabs[k]));
        check_geometry(lightfield.slabs.back(), slabs[k].where());
        description.has_sigma.push_back(slabs[k].at("has_sigma").boolean());
        constexpr int kMostReplicates = 1000;
        description.replicate_count.push_back(
            slabs[k].has("replicates")
                ? static_cast<std::size_t>(slabs[k].at("replicates").integer(0, kMostReplicates))
                : 0);
    }
    if (description.kind.kind == "luminaire")
        description.has_tables = root.at("has_tables").boolean();
    return description;
}

}  // namespace nearfield
