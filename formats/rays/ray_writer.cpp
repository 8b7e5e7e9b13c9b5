// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/ray_writer.h"

#include "formats/files/error.h"
#include "formats/rays/color.h"
#include "formats/rays/lighttools.h"
#include "formats/rays/tm25.h"
#include "formats/rays/zemax.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <filesystem>

namespace nearfield::rays {
namespace {

constexpr float kMmPerM = 1000;

// Little-endian numbers at places of a header that is filled with zeros.
class HeaderBytes {
  public:
    explicit HeaderBytes(std::uint64_t size) : bytes_(size, '\0') {}
    template <typename T>
    void put(std::uint64_t byte, T value) {
        std::memcpy(bytes_.data() + byte, &value, sizeof value);
    }
    void put_text(std::uint64_t byte, std::uint64_t most, const std::string& text) {
        std::copy_n(text.begin(), std::min<std::uint64_t>(most, text.size()),
                    bytes_.begin() + static_cast<std::ptrdiff_t>(byte));
    }
    const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

bool is_luminous(const RayFileFacts& facts) {
    return facts.quantity == Quantity::Photometric;
}

std::string tm25_header(const RayFileFacts& facts) {
    // Texts are UTF-32; the fourth names who made the rays (section 4.7.3).
    constexpr std::uint64_t kCreatorByte = 288 + 3 * 4000, kMostCreator = 999;
    HeaderBytes header(kTm25TablesByte);
    header.put_text(0, 4, "TM25");
    header.put(4, kTm25Version);
    const auto flux = static_cast<float>(facts.flux);
    header.put(is_luminous(facts) ? 12 : 16, flux);
    header.put(20, facts.ray_count);
    constexpr std::array<int, 2> kPositionAndDirection{1, 1};
    header.put(kTm25FlagsByte, kPositionAndDirection);
    header.put(kTm25FlagsByte + (is_luminous(facts) ? 16 : 8), 1);
    header.put(kTm25FlagsByte + 24, facts.has_color ? 1 : 0);
    for (std::uint64_t k = 0; k < std::min<std::uint64_t>(facts.creator.size(), kMostCreator); ++k)
        header.put_text(kCreatorByte + 4 * k, 1, facts.creator.substr(k, 1));
    return header.bytes();
}

std::string zemax_header(const RayFileFacts& facts) {
    HeaderBytes header(kZemaxHeaderBytes);
    header.put(0, kZemaxIdentifier);
    header.put(4, static_cast<std::uint32_t>(facts.ray_count));
    header.put_text(8, kZemaxTextBytes - 1, facts.creator);
    header.put(108, static_cast<float>(facts.flux));  // of the source
    header.put(112, static_cast<float>(facts.flux));  // of these rays
    header.put(136, kZemaxMm);
    header.put(196, is_luminous(facts) ? 1 : 0);
    return header.bytes();
}

std::string lighttools_header(const RayFileFacts& facts) {
    HeaderBytes header(44);
    header.put_text(0, 4, std::string(kLightToolsMagic));
    header.put(4, 2U);  // version
    header.put(12, is_luminous(facts) ? 1U : 0U);
    header.put(24, 1U);  // mm
    header.put(40, static_cast<float>(facts.flux));
    return header.bytes();
}

std::string lighttools_text_header(const RayFileFacts& facts) {
    return fmt::format(
        "# LightTools\n# {}\nlt_rdf_version: 2.0\nlt_datatype: {}\nlt_far_field_data: no\n"
        "lt_color_info: none\nlt_length_units: millimeters\nlt_data_origin: 0 0 0\n"
        "lt_radiant_flux: {:.9g}\n{}\n",
        facts.creator, is_luminous(facts) ? "luminous_flux" : "radiant_flux", facts.flux,
        kLightToolsTextStart);
}

bool is_text(RayFormat format) {
    return format == RayFormat::ZemaxText || format == RayFormat::LightToolsText;
}

}  // namespace

std::vector<std::pair<std::string, RayFormat>> ray_format_names() {
    return {{"tm25", RayFormat::Tm25},
            {"zemax", RayFormat::Zemax},
            {"zemax-text", RayFormat::ZemaxText},
            {"lighttools", RayFormat::LightTools},
            {"lighttools-text", RayFormat::LightToolsText}};
}

RayFormat ray_format_of(const std::string& path) {
    std::string suffix = std::filesystem::path(path).extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (suffix == ".tm25ray")
        return RayFormat::Tm25;
    if (suffix == ".dat")
        return RayFormat::Zemax;
    if (suffix == ".txt")
        return RayFormat::ZemaxText;
    if (suffix == ".ray")
        return RayFormat::LightTools;
    throw Error{"unknown format of ray file", path, ".tm25ray, .dat, .txt, .ray, or --format",
                suffix};
}

RayWriter::RayWriter(const std::string& path, RayFileFacts facts)
    : facts_(std::move(facts)), file_(path) {
    constexpr std::uint64_t kMostZemax = 4'000'000'000;
    const bool is_zemax =
        facts_.format == RayFormat::Zemax || facts_.format == RayFormat::ZemaxText;
    if (is_zemax && facts_.ray_count > kMostZemax)
        throw Error{"too many rays for the format", path, "at most 4e9",
                    std::to_string(facts_.ray_count)};
    facts_.has_color = facts_.has_color && facts_.format == RayFormat::Tm25;
    put(header());
}

std::string RayWriter::header() const {
    switch (facts_.format) {
        case RayFormat::Tm25:
            return tm25_header(facts_);
        case RayFormat::Zemax:
            return zemax_header(facts_);
        case RayFormat::ZemaxText:
            return fmt::format("{} {}\n", facts_.ray_count, kZemaxMm);
        case RayFormat::LightTools:
            return lighttools_header(facts_);
        case RayFormat::LightToolsText:
            return lighttools_text_header(facts_);
    }
    return {};
}

void RayWriter::put(const std::string& bytes) {
    file_.write_at(bytes.data(), bytes.size(), position_);
    position_ += bytes.size();
}

// The same in all binary formats, but for TM-25's X and Z behind the flux.
std::string RayWriter::binary_rows(std::span<const Ray> rays,
                                   std::span<const glm::vec3> colors) const {
    const std::size_t columns = facts_.has_color ? 9 : 7;
    std::string bytes(rays.size() * columns * sizeof(float), '\0');
    for (std::size_t r = 0; r < rays.size(); ++r) {
        const Ray& ray = rays[r];
        const glm::vec3 p = kMmPerM * ray.position_m, d = ray.direction;
        std::array<float, 9> row{p.x, p.y, p.z, d.x, d.y, d.z, ray.flux};
        if (facts_.has_color) {
            const glm::vec3 xyz = ray.flux * glm::vec3(xyz_of(colors[r]));
            row[7] = xyz.x;
            row[8] = xyz.z;
        }
        std::memcpy(bytes.data() + r * columns * sizeof(float), row.data(),
                    columns * sizeof(float));
    }
    return bytes;
}

std::string RayWriter::text_rows(std::span<const Ray> rays) {
    fmt::memory_buffer text;
    for (const Ray& ray : rays) {
        const glm::vec3 p = kMmPerM * ray.position_m, d = ray.direction;
        fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {}\n", p.x, p.y, p.z, d.x, d.y,
                       d.z, ray.flux);
    }
    return fmt::to_string(text);
}

void RayWriter::add(std::span<const Ray> rays, std::span<const glm::vec3> colors) {
    constexpr std::size_t kBlock = 8192;
    std::vector<std::string> blocks((rays.size() + kBlock - 1) / kBlock);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        const std::size_t first = b * kBlock, count = std::min(kBlock, rays.size() - first);
        const auto block_colors = facts_.has_color ? colors.subspan(first, count) : colors;
        blocks[b] = is_text(facts_.format) ? text_rows(rays.subspan(first, count))
                                           : binary_rows(rays.subspan(first, count), block_colors);
    });
    for (const std::string& block : blocks)
        put(block);
    added_ += rays.size();
}

void RayWriter::commit() {
    assert(added_ == facts_.ray_count);
    if (facts_.format == RayFormat::LightTools)
        put(std::string(kLightToolsEnd));
    if (facts_.format == RayFormat::LightToolsText)
        put(std::string(kLightToolsTextEnd) + "\n");
    file_.commit();
}

}  // namespace nearfield::rays
