// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/tm25.h"

#include "formats/files/error.h"
#include "formats/rays/byte_reader.h"
#include "formats/rays/color.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>

namespace nearfield::rays {
namespace {

constexpr std::uint64_t kFlagsByte = 256;     // section 4.7.2
constexpr std::uint64_t kTablesByte = 36288;  // after nine text fields of 4000 bytes, section 4.7.3
constexpr std::uint64_t kColumnNameBytes = 512;  // section 4.7.5
constexpr std::int32_t kVersion = 2013;
constexpr std::size_t kRaysPerChunk = 65536;

struct SpectralTable {
    std::vector<float> wavelength_nm, weight;  // weight: radiant power per nm, any scale
};

struct Header {
    float luminous_flux_lm = 0, radiant_flux_w = 0;  // NaN or 0: not stated
    std::uint64_t ray_count = 0;
    std::int32_t spectral_data =
        0;  // 0 none, 1 one wavelength, 2 one a ray, 3 one table, 4 a table a ray
    float wavelength_nm = 0;
    bool has_radiant = false, has_wavelength = false, has_luminous = false, has_stokes = false;
    bool has_tristimulus = false, has_spectrum_index = false;
    std::vector<SpectralTable> tables;
    std::uint64_t additional_items = 0;
    std::uint64_t data_byte = 0;
};

// Where each known item stands in a ray's row of floats; positions and directions are columns 0
// ... 5.
struct Columns {
    std::optional<std::size_t> radiant, wavelength, luminous, tristimulus_x, tristimulus_z,
        spectrum;
    std::size_t count = 6;

    explicit Columns(const Header& header) {
        const auto place = [this](bool present) {
            return present ? std::optional<std::size_t>(count++) : std::nullopt;
        };
        radiant = place(header.has_radiant);
        wavelength = place(header.has_wavelength);
        luminous = place(header.has_luminous);
        if (header.has_stokes)
            count += 6;  // S1, S2, S3 and the reference axis, not needed here
        tristimulus_x = place(header.has_tristimulus);
        tristimulus_z = place(header.has_tristimulus);
        spectrum = place(header.has_spectrum_index);
        count += header.additional_items;
    }
};

void refuse_other_formats(const ByteReader& file,
                          const std::array<char, 4>& magic,
                          const std::string& path) {
    const auto not_yet = [&](const char* program) {
        throw Error{fmt::format("{} ray files are not yet a supported format", program), file.at(0),
                    "a TM-25 file ('TM25')"};
    };
    if (std::memcmp(magic.data(), "LTRF", 4) == 0)
        not_yet("LightTools (binary)");
    if (std::memcmp(magic.data(), "# Li", 4) == 0)
        not_yet("LightTools (text)");
    std::int32_t first = 0;
    std::memcpy(&first, magic.data(), 4);
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (first == 1010)  // Zemax' own identifier
        not_yet("Zemax");
    if (extension == ".ray" || extension == ".dat" || extension == ".sdf")
        not_yet("Speos or Zemax");
}

std::int32_t read_flag(ByteReader& file, const char* name) {
    const std::uint64_t byte = file.position();
    const auto value = file.read<std::int32_t>();
    if (value != 0 && value != 1)
        throw Error{fmt::format("bad {} flag in ray file", name), file.at(byte), "0 or 1",
                    std::to_string(value)};
    return value;
}

std::int32_t read_count(ByteReader& file, const char* name, std::int32_t least) {
    const std::uint64_t byte = file.position();
    const auto value = file.read<std::int32_t>();
    if (value < least)
        throw Error{fmt::format("bad {} in ray file", name), file.at(byte),
                    fmt::format(">= {}", least), std::to_string(value)};
    return value;
}

void read_flags(ByteReader& file, Header& header) {
    file.seek(kFlagsByte);
    if (read_flag(file, "position") + read_flag(file, "direction") != 2)
        throw Error{"ray file without positions or directions", file.at(kFlagsByte), "flags 1, 1"};
    header.has_radiant = read_flag(file, "radiant flux") == 1;
    header.has_wavelength = read_flag(file, "wavelength") == 1;
    header.has_luminous = read_flag(file, "luminous flux") == 1;
    header.has_stokes = read_flag(file, "Stokes") == 1;
    header.has_tristimulus = read_flag(file, "tristimulus") == 1;
    header.has_spectrum_index = read_flag(file, "spectrum index") == 1;
    if (!header.has_radiant && !header.has_luminous)
        throw Error{"ray file without flux", file.at(kFlagsByte + 8),
                    "the radiant or the luminous flux flag set"};
}

void read_tables(ByteReader& file, Header& header, std::int32_t table_count) {
    file.seek(kTablesByte);
    for (std::int32_t t = 0; t < table_count; ++t) {
        const auto pairs = static_cast<std::uint64_t>(read_count(file, "spectral table's size", 1));
        file.need(pairs * 8);
        SpectralTable table;
        for (std::uint64_t p = 0; p < pairs; ++p) {
            const std::uint64_t byte = file.position();
            table.wavelength_nm.push_back(file.read<float>());
            table.weight.push_back(file.read<float>());
            const float l = table.wavelength_nm.back();
            const bool rises = p == 0 || l > table.wavelength_nm[p - 1];
            if (!std::isfinite(l) || l <= 0 || !rises || !std::isfinite(table.weight.back()) ||
                table.weight.back() < 0)
                throw Error{"bad entry of a spectral table", file.at(byte),
                            "rising wavelengths > 0 and finite weights >= 0",
                            fmt::format("{} nm, {}", l, table.weight.back())};
        }
        header.tables.push_back(std::move(table));
    }
    // Padding to a multiple of 32 bytes.
    file.seek(kTablesByte + (file.position() - kTablesByte + 31) / 32 * 32);
}

void check_spectral_data(const ByteReader& file, const Header& header) {
    const auto refuse = [&](const char* expected) {
        throw Error{"contradictory spectral data in ray file", file.at(60), expected,
                    fmt::format("identifier {}", header.spectral_data)};
    };
    if (header.spectral_data < 0 || header.spectral_data > 4)
        refuse("identifier 0 ... 4");
    if (header.spectral_data == 1 && !(header.wavelength_nm > 0))
        refuse("a wavelength > 0 at byte 64");
    if (header.spectral_data == 2 && !header.has_wavelength)
        refuse("a wavelength with every ray");
    if (header.spectral_data >= 3 && header.tables.empty())
        refuse("a spectral table");
    if (header.spectral_data == 4 && !header.has_spectrum_index)
        refuse("a spectrum index with every ray");
    if (header.has_tristimulus && !header.has_luminous)
        refuse("luminous flux (Y) beside tristimulus X and Z");
}

Header read_header(ByteReader& file, const std::string& path) {
    const auto magic = file.read<std::array<char, 4>>();
    if (std::memcmp(magic.data(), "TM25", 4) != 0) {
        refuse_other_formats(file, magic, path);
        throw Error{"not a TM-25 ray file", file.at(0), "'TM25'"};
    }
    const auto version = file.read<std::int32_t>();
    if (version != kVersion)
        throw Error{"unknown version of a ray file", file.at(4), std::to_string(kVersion),
                    std::to_string(version)};
    Header header;
    file.seek(12);  // byte 8: simulated or measured
    header.luminous_flux_lm = file.read<float>();
    header.radiant_flux_w = file.read<float>();
    header.ray_count = file.read<std::uint64_t>();
    file.seek(60);  // date and where rays start: nothing depends on them
    header.spectral_data = file.read<std::int32_t>();
    header.wavelength_nm = file.read<float>();
    file.seek(76);
    const auto table_count = read_count(file, "number of spectral tables", 0);
    header.additional_items =
        static_cast<std::uint64_t>(read_count(file, "number of additional items", 0));
    const auto text_bytes =
        static_cast<std::uint64_t>(read_count(file, "size of the additional text", 0));
    read_flags(file, header);
    read_tables(file, header, table_count);
    check_spectral_data(file, header);
    header.data_byte = file.position() + header.additional_items * kColumnNameBytes + text_bytes;
    file.seek(header.data_byte);
    return header;
}

// A spectrum's color and luminous efficacy.
struct Light {
    UnitColor color;
    double lm_per_w = 0;
};

Light monochromatic(double wavelength_nm) {
    const glm::dvec3 xyz = color_matching(wavelength_nm);
    return {unit_color(xyz), kPeakEfficacyLmPerW * xyz.y};
}

// Trapezoidal rule over the table, as TM-25 connects its points by straight lines.
Light integrate(const SpectralTable& table) {
    glm::dvec3 xyz{0.0};
    double power = 0.0;
    for (std::size_t i = 0; i < table.weight.size(); ++i) {
        const double l = table.wavelength_nm[i];
        const double below = i > 0 ? l - table.wavelength_nm[i - 1] : 0.0;
        const double above = i + 1 < table.weight.size() ? table.wavelength_nm[i + 1] - l : 0.0;
        const double share =
            table.weight.size() == 1 ? 1.0 : 0.5 * (below + above) * table.weight[i];
        xyz += share * color_matching(l);
        power += share;
    }
    return {unit_color(xyz), power > 0 ? kPeakEfficacyLmPerW * xyz.y / power : 0.0};
}

// Turns rows of floats into rays.
class Decoder {
  public:
    Decoder(const Header& header, const Columns& columns, const ReadOptions& options, RaySet& out)
        : header_(header), columns_(columns), out_(out) {
        for (const SpectralTable& table : header.tables)
            lights_.push_back(integrate(table));
        knows_light_ = header.spectral_data > 0 || header.has_tristimulus;
        to_luminous_ = !header.has_luminous && knows_light_ && !options.keep_radiometric;
        const bool photometric = header.has_luminous || to_luminous_;
        out.quantity = photometric ? Quantity::Photometric : Quantity::Radiometric;
        colored_ = photometric && knows_light_;
        shared_color_ = header.spectral_data == 1 || header.spectral_data == 3;
        if (colored_ && shared_color_)
            add_color(shared_light().color);
    }

    template <typename Where>
    void decode(const float* row, const Where& where_of) {
        for (std::size_t c = 0; c < columns_.count - header_.additional_items; ++c)
            if (c < 6 || is_used(c))
                if (!std::isfinite(row[c]))
                    throw Error{"ray file holds a number that is not finite", where_of(),
                                "a number", fmt::format("{} in item {}", row[c], c)};
        const glm::dvec3 direction{row[3], row[4], row[5]};
        const double length = glm::length(direction);
        if (!(length > 1e-12))
            throw Error{"ray without direction", where_of(), "a vector of unit length",
                        "(0, 0, 0)"};
        const double stored = row[header_.has_luminous ? *columns_.luminous : *columns_.radiant];
        if (stored < 0)
            throw Error{"negative flux in ray file", where_of(), ">= 0", fmt::format("{}", stored)};
        Light light;
        if (colored_ && !(shared_color_ && !to_luminous_))
            light = shared_color_ ? shared_light() : light_of(row, where_of);
        const double flux = to_luminous_ ? stored * light.lm_per_w : stored;
        if (colored_ && !shared_color_)
            add_color(light.color);
        out_.flux_of_rays += flux;
        out_.rays.push_back({glm::vec3(1e-3 * glm::dvec3(row[0], row[1], row[2])),
                             glm::vec3(direction / length), static_cast<float>(flux)});
    }

    bool to_luminous() const { return to_luminous_; }

  private:
    bool is_used(std::size_t column) const {
        return column == columns_.radiant || column == columns_.luminous ||
               column == columns_.wavelength || column == columns_.tristimulus_x ||
               column == columns_.tristimulus_z || column == columns_.spectrum;
    }

    Light shared_light() const {
        return header_.spectral_data == 1 ? monochromatic(header_.wavelength_nm) : lights_.front();
    }

    template <typename Where>
    Light light_of(const float* row, const Where& where_of) const {
        if (header_.has_tristimulus)
            return {unit_color({row[*columns_.tristimulus_x], row[*columns_.luminous],
                                row[*columns_.tristimulus_z]}),
                    0.0};
        if (header_.spectral_data == 2)
            return monochromatic(row[*columns_.wavelength]);
        const float index = row[*columns_.spectrum];  // counted from 1
        if (!(index >= 1 && index <= static_cast<float>(lights_.size())))
            throw Error{"ray with an unknown spectrum", where_of(),
                        fmt::format("1 ... {}", lights_.size()), fmt::format("{}", index)};
        return lights_[static_cast<std::size_t>(index) - 1];
    }

    void add_color(const UnitColor& color) {
        out_.colors.emplace_back(color.rgb);
        out_.desaturated += color.desaturated ? 1 : 0;
    }

    const Header& header_;
    const Columns& columns_;
    RaySet& out_;
    std::vector<Light> lights_;
    bool knows_light_ = false, to_luminous_ = false, colored_ = false, shared_color_ = false;
};

// Scales the rays to the total that the header states, if it does.
void scale_to_header(const Header& header,
                     bool converted,
                     const ReadOptions& options,
                     RaySet& set) {
    const bool luminous = set.quantity == Quantity::Photometric;
    const double stated = luminous ? header.luminous_flux_lm : header.radiant_flux_w;
    const char* unit = luminous ? "lm" : "W";
    if (converted)
        set.notes.push_back("radiant flux was turned into luminous flux by the file's spectra");
    if (!(std::isfinite(stated) && stated > 0))
        return;
    set.flux_stated = stated;
    // 1e-5: a sum of 100,000 floats may be off by this much without being another number.
    if (std::abs(stated - set.flux_of_rays) <= 1e-5 * stated)
        return;
    set.notes.push_back(fmt::format(
        "rays sum to {:.6g} {}, the header states {:.6g} {}: {}", set.flux_of_rays, unit, stated,
        unit, options.keep_ray_flux ? "kept the rays' sum" : "scaled to the header"));
    if (options.keep_ray_flux)
        return;
    const double scale = stated / set.flux_of_rays;
    for (Ray& ray : set.rays)
        ray.flux = static_cast<float>(ray.flux * scale);
}

// Compares what the header promises with the file's size, before anything is allocated for it.
void check_length(const ByteReader& file, const Header& header, std::uint64_t row_bytes) {
    const std::uint64_t whole_rays = file.remaining() / row_bytes;
    if (header.ray_count == 0)
        throw Error{"ray file without rays", file.at(20), ">= 1 ray", "0"};
    if (whole_rays < header.ray_count)
        throw Error{"ray file is truncated",
                    fmt::format("{}, ray {}", file.at(file.size()), whole_rays),
                    fmt::format("{} rays of {} bytes", header.ray_count, row_bytes),
                    fmt::format("{} whole rays", whole_rays)};
    if (file.remaining() != header.ray_count * row_bytes)
        throw Error{"ray file is longer than its header says",
                    file.at(header.data_byte + header.ray_count * row_bytes), "the end of the file",
                    fmt::format("{} more bytes", file.remaining() - header.ray_count * row_bytes)};
}

}  // namespace

double flux(const RaySet& set) {
    double sum = 0.0;
    for (const Ray& ray : set.rays)
        sum += ray.flux;
    return sum;
}

RaySet read_tm25(const std::string& path, const ReadOptions& options) {
    ByteReader file(path);
    const Header header = read_header(file, path);
    const Columns columns(header);
    const std::uint64_t row_bytes = columns.count * sizeof(float);
    check_length(file, header, row_bytes);

    RaySet set;
    set.rays.reserve(header.ray_count);
    Decoder decoder(header, columns, options, set);
    std::vector<float> chunk(std::min<std::uint64_t>(kRaysPerChunk, header.ray_count) *
                             columns.count);
    for (std::uint64_t first = 0; first < header.ray_count; first += kRaysPerChunk) {
        const auto rows = std::min<std::uint64_t>(kRaysPerChunk, header.ray_count - first);
        const std::uint64_t byte = file.position();
        file.read(chunk.data(), rows * row_bytes);
        for (std::uint64_t r = 0; r < rows; ++r) {
            const auto where = [&] {
                return fmt::format("{}, ray {}", file.at(byte + r * row_bytes), first + r);
            };
            decoder.decode(&chunk[r * columns.count], where);
        }
        if (options.progress)
            options.progress(static_cast<double>(first + rows) /
                             static_cast<double>(header.ray_count));
    }
    if (!(set.flux_of_rays > 0 && std::isfinite(set.flux_of_rays)))
        throw Error{"ray file without light", path, "a sum of flux > 0",
                    fmt::format("{}", set.flux_of_rays)};
    scale_to_header(header, decoder.to_luminous(), options, set);
    for (std::size_t r = 0; r < set.rays.size(); ++r)
        if (!std::isfinite(set.rays[r].flux))
            throw Error{"flux too large", fmt::format("{}, ray {}", path, r), "a finite number"};
    return set;
}

}  // namespace nearfield::rays
