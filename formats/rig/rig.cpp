// SPDX-License-Identifier: Apache-2.0
#include "formats/rig/rig.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/image.h"
#include "formats/files/json_visit.h"
#include "formats/files/provenance_json.h"
#include "formats/files/read_file.h"
#include "formats/rig/rig_fields.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace nearfield::rig {
namespace {

namespace fs = std::filesystem;

constexpr int kMostPixels = 1 << 16;     // along an axis
constexpr int kMostPositions = 512;      // along an axis of the stage
constexpr double kRotationError = 1e-9;  // of a matrix that a program wrote

using MapOf = std::vector<float> Maps::*;
constexpr std::array<std::pair<const char*, MapOf>, 6> kMaps = {
    {{"black_dn", &Maps::black_dn},
     {"dark_dn_per_s", &Maps::dark_dn_per_s},
     {"response", &Maps::response},
     {"response_sigma_rel", &Maps::response_sigma_rel},
     {"is_bad", &Maps::is_bad},
     {"room_dn_per_s", &Maps::room_dn_per_s}}};

// "rig.json" has its maps in "rig.maps.exr" beside it.
std::string maps_path(const std::string& rig_path) {
    return fs::path(rig_path).replace_extension(".maps.exr").string();
}

class RigCheck {
  public:
    explicit RigCheck(std::string where) : where_(std::move(where)) {}

    void that(bool is_right,
              const std::string& key,
              const std::string& expected,
              double got) const {
        if (!is_right)
            throw Error{"bad rig", where_ + "." + key, expected, fmt::format("{}", got)};
    }
    void positive(const std::string& key, double value) const {
        that(value > 0 && std::isfinite(value), key, "a number above 0", value);
    }
    void at_least_zero(const std::string& key, double value) const {
        that(value >= 0 && std::isfinite(value), key, "a number of at least 0", value);
    }
    void count(const std::string& key, std::size_t got, std::size_t expected) const {
        if (got != expected)
            throw Error{"bad rig", where_ + "." + key, fmt::format("{} elements", expected),
                        fmt::format("{}", got)};
    }

  private:
    std::string where_;
};

void check_lens(const Lens& lens, const RigCheck& check) {
    check.that(lens.size_px.x >= 1 && lens.size_px.x <= kMostPixels, "lens.size_px[0]",
               fmt::format("1 ... {}", kMostPixels), lens.size_px.x);
    check.that(lens.size_px.y >= 1 && lens.size_px.y <= kMostPixels, "lens.size_px[1]",
               fmt::format("1 ... {}", kMostPixels), lens.size_px.y);
    check.positive("lens.fx_px", lens.fx_px);
    check.positive("lens.fy_px", lens.fy_px);
    check.count("lens.distortion", lens.distortion.size(),
                static_cast<std::size_t>(distortion_count(lens.model)));
}

void check_planes(const Planes& planes, const RigCheck& check) {
    check.that(planes.grid.x >= 1 && planes.grid.x <= kMostPositions, "planes.grid[0]",
               fmt::format("1 ... {}", kMostPositions), planes.grid.x);
    check.that(planes.grid.y >= 1 && planes.grid.y <= kMostPositions, "planes.grid[1]",
               fmt::format("1 ... {}", kMostPositions), planes.grid.y);
    check.positive("planes.delta_m", planes.delta_m);
    check.positive("planes.pitch_m[0]", planes.pitch_m.x);
    check.positive("planes.pitch_m[1]", planes.pitch_m.y);
    check.count("planes.position_m", planes.position_m.size(),
                static_cast<std::size_t>(planes.grid.x) * static_cast<std::size_t>(planes.grid.y));
    for (const glm::dvec3& position_m : planes.position_m)
        check.that(position_m.z < 0, "planes.position_m", "z below 0: behind S", position_m.z);
    const glm::dmat3& rotation = planes.camera_from_slab.rotation;
    const glm::dmat3 product = glm::transpose(rotation) * rotation;
    double worst = std::abs(glm::determinant(rotation) - 1.0);
    for (int k = 0; k < 9; ++k)
        worst = std::max(worst, std::abs(product[k / 3][k % 3] - (k % 4 == 0 ? 1.0 : 0.0)));
    check.that(worst <= kRotationError, "planes.camera_from_slab.rotation",
               "a proper rotation (determinant +1)", worst);
}

void check_curve(const Curve& curve, const std::string& key, const RigCheck& check) {
    check.count(key + ".y", curve.y.size(), curve.x.size());
    for (std::size_t k = 1; k < curve.x.size(); ++k)
        check.that(curve.x[k] > curve.x[k - 1], key + ".x", "ascending numbers", curve.x[k]);
}

void check_radiometry(const Radiometry& radiometry, const RigCheck& check) {
    check.that(radiometry.bits >= 1 && radiometry.bits <= 16, "radiometry.bits", "1 ... 16",
               radiometry.bits);
    check.positive("radiometry.saturation_dn", radiometry.saturation_dn);
    check.positive("radiometry.gain_e_per_dn", radiometry.gain_e_per_dn);
    check.at_least_zero("radiometry.read_noise_dn", radiometry.read_noise_dn);
    check.that(radiometry.veil_share >= 0 && radiometry.veil_share < 0.5, "radiometry.veil_share",
               "0 ... 0.5", radiometry.veil_share);
    check.positive("radiometry.scale_lx_s_per_dn", radiometry.scale_lx_s_per_dn);
    check.at_least_zero("radiometry.scale_sigma_rel", radiometry.scale_sigma_rel);
    check.at_least_zero("radiometry.scale_systematic_rel", radiometry.scale_systematic_rel);
    for (const TrueExposure& exposure : radiometry.exposures)
        check.positive("radiometry.exposures", std::min(exposure.asked_us, exposure.true_us));
    check_curve(radiometry.linear, "radiometry.linear", check);
    check_curve(radiometry.screen, "radiometry.screen", check);
    for (const double factor : radiometry.screen.y)
        check.positive("radiometry.screen.y", factor);
}

void check_maps(const Maps& maps, glm::ivec2 size_px, const std::string& where) {
    const RigCheck check(where);
    const auto count = static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
    if (maps.size_px != size_px)
        throw Error{"bad rig", where, fmt::format("{} x {} px", size_px.x, size_px.y),
                    fmt::format("{} x {} px", maps.size_px.x, maps.size_px.y)};
    for (const auto& [name, member] : kMaps) {
        check.count(name, (maps.*member).size(), count);
        for (const float value : maps.*member)
            check.that(std::isfinite(value), name, "finite numbers", value);
    }
}

Picture picture_of(const Maps& maps, const Provenance& provenance) {
    Picture picture;
    picture.size_px = maps.size_px;
    for (const auto& [name, member] : kMaps)
        picture.layers.push_back({"", {name}, maps.*member});
    picture.provenance = provenance;
    return picture;
}

}  // namespace

double dark_growth(double warmer_c) {
    constexpr double kDoubling_c = 7;
    return std::exp2(warmer_c / kDoubling_c);
}

double dark_growth(const Radiometry& radiometry, std::optional<double> temperature_c) {
    return temperature_c ? dark_growth(*temperature_c - radiometry.dark_temperature_c) : 1.0;
}

void check(const Rig& rig, const std::string& where) {
    const RigCheck check(where);
    if (!rig.lens && !rig.radiometry)
        throw Error{"bad rig", where, "a lens or radiometry", "neither"};
    if (rig.lens)
        check_lens(*rig.lens, check);
    if (rig.planes)
        check_planes(*rig.planes, check);
    if (rig.radiometry)
        check_radiometry(*rig.radiometry, check);
    check.count("covariance", rig.covariance.size(),
                rig.covariance_of.size() * rig.covariance_of.size());
}

void write_rig(const Rig& rig,
               const Maps& maps,
               const std::optional<RunRecord>& run,
               const std::string& path) {
    check(rig, path);
    const std::string maps_file = maps_path(path);
    if (rig.radiometry) {
        check_maps(maps, rig.lens ? rig.lens->size_px : maps.size_px, maps_file);
        write_picture(picture_of(maps, rig.provenance), run, maps_file);
    }
    FieldWriter writer;
    Rig copy = rig;  // fields are visited for reading and writing alike
    visit_fields(writer, copy);
    Json document = {{"nearfield_rig", kRigVersion}};
    document.update(writer.json);
    if (rig.radiometry)
        document["maps"] = {{"file", fs::path(maps_file).filename().string()},
                            {"xxh128", hash_file(maps_file)}};
    document["provenance"] = json_of(rig.provenance);
    if (run)
        document["run"] = {{"date_utc", run->date_utc},
                           {"time_s", run->time_s},
                           {"peak_memory_mib", run->peak_memory_mib},
                           {"threads", run->threads}};
    write_file(document.dump(2) + "\n", path);
}

Rig read_rig(const std::string& path) {
    const Json document = parse_json(read_file(path), path);
    const JsonField field(document, path);
    const int version = field.at("nearfield_rig").integer(0, 1 << 30);
    if (version > kRigVersion || version < 1)
        throw Error{"cannot read rig", path, fmt::format("version 1 ... {}", kRigVersion),
                    fmt::format("{}", version)};
    Rig rig;
    FieldReader reader(field, Missing::Refused);
    visit_fields(reader, rig);
    rig.provenance = provenance_from(field.at("provenance"));
    check(rig, path);
    return rig;
}

Maps read_maps(const std::string& rig_path) {
    const Json document = parse_json(read_file(rig_path), rig_path);
    const JsonField field = JsonField(document, rig_path).at("maps");
    const std::string name = field.at("file").text();
    const std::string path =
        (fs::path(rig_path).parent_path() / fs::path(name).filename()).string();
    const std::string expected = field.at("xxh128").text();
    if (const std::string got = hash_file(path); got != expected)
        throw Error{"not the maps that belong to " + rig_path, path, "XXH128 " + expected, got};
    const Picture picture = read_picture(path);
    Maps maps;
    maps.size_px = picture.size_px;
    for (const auto& [map, member] : kMaps)
        for (const Layer& layer : picture.layers)
            for (std::size_t c = 0; c < layer.channels.size(); ++c)
                if (layer.channels[c] == map)
                    for (std::size_t k = c; k < layer.values.size(); k += layer.channels.size())
                        (maps.*member).push_back(layer.values[k]);
    check_maps(maps, picture.size_px, path);
    return maps;
}

}  // namespace nearfield::rig
