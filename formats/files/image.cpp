// SPDX-License-Identifier: Apache-2.0
#include "formats/files/image.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/exr_file.h"
#include "formats/files/metadata.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <map>

namespace nearfield {
namespace {

constexpr const char* kPart = "picture";

std::string channel_name(const Layer& layer, const std::string& channel) {
    return layer.name.empty() ? channel : layer.name + "." + channel;
}

/// A layer's array [row][column][channel] as planes of a 1 x 1 atlas.
template <typename Value, typename LayerType>
void add_planes(exr::Atlas<Value>& atlas, LayerType& layer) {
    const auto count = static_cast<std::ptrdiff_t>(layer.channels.size());
    for (std::ptrdiff_t c = 0; c < count; ++c)
        atlas.planes.push_back({channel_name(layer, layer.channels[static_cast<std::size_t>(c)]),
                                layer.values.data(), c, 0, count, count * atlas.image.x});
}

std::size_t pixel_count(glm::ivec2 size_px) {
    return static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
}

void check_size(glm::ivec2 size_px, const std::string& path) {
    if (size_px.x < 1 || size_px.y < 1)
        throw Error{"bad picture", path, "at least 1 x 1 pixels",
                    fmt::format("{} x {}", size_px.x, size_px.y)};
}

/// EXR sorts channels by name; people expect R G B A.
bool comes_before(const std::string& a, const std::string& b) {
    static const std::string order = "RGBA";
    const std::size_t rank_a = a.size() == 1 ? order.find(a) : std::string::npos;
    const std::size_t rank_b = b.size() == 1 ? order.find(b) : std::string::npos;
    return rank_a != rank_b ? rank_a < rank_b : a < b;
}

std::vector<Layer> layers_of(const std::vector<std::string>& channels) {
    std::map<std::string, Layer> by_name;
    for (const std::string& full_name : channels) {
        const std::size_t dot = full_name.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : full_name.substr(0, dot);
        by_name[layer].name = layer;
        by_name[layer].channels.push_back(dot == std::string::npos ? full_name
                                                                   : full_name.substr(dot + 1));
    }
    std::vector<Layer> layers;
    for (auto& [name, layer] : by_name) {
        std::sort(layer.channels.begin(), layer.channels.end(), comes_before);
        layers.push_back(std::move(layer));
    }
    return layers;
}

}  // namespace

void write_picture(const Picture& picture,
                   const std::optional<RunRecord>& run,
                   const std::string& path) {
    check_size(picture.size_px, path);
    exr::Atlas<const float> atlas{kPart, {1, 1}, picture.size_px, {}, exr::Values::Any, false};
    for (const Layer& layer : picture.layers) {
        const std::size_t expected = pixel_count(picture.size_px) * layer.channels.size();
        if (layer.values.size() != expected)
            throw Error{"bad picture", path + ", layer '" + layer.name + "'",
                        fmt::format("{} values", expected), fmt::format("{}", layer.values.size())};
        add_planes(atlas, layer);
    }
    if (atlas.planes.empty())
        throw Error{"bad picture", path, "at least one channel"};
    exr::write({atlas}, exr::Compression::Zip, provenance_attributes(picture.provenance, run),
               path);
}

Picture read_picture(const std::string& path) {
    exr::Reader reader(path);
    if (reader.part_count() != 1)
        throw Error{"not a picture", path, "one part", fmt::format("{}", reader.part_count())};
    const exr::Part part = reader.part(0);
    Picture picture;
    picture.size_px = part.size;
    picture.layers = layers_of(part.channels);
    picture.provenance = read_provenance(reader, path);

    for (const bool is_reading : {false, true}) {
        exr::Atlas<float> atlas{part.name, {1, 1}, part.size, {}, exr::Values::Any, false};
        for (Layer& layer : picture.layers) {
            if (is_reading)
                layer.values.resize(pixel_count(picture.size_px) * layer.channels.size());
            add_planes(atlas, layer);
        }
        if (is_reading)
            reader.read(atlas);
        else
            reader.require(atlas);
    }
    return picture;
}

void write_png(const std::vector<unsigned char>& rgb, glm::ivec2 size_px, const std::string& path) {
    check_size(size_px, path);
    if (rgb.size() != 3 * pixel_count(size_px))
        throw Error{"bad picture", path, fmt::format("{} bytes", 3 * pixel_count(size_px)),
                    fmt::format("{}", rgb.size())};
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(size_px.x);
    image.height = static_cast<png_uint_32>(size_px.y);
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string bytes(size, '\0');
    if (png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
        throw Error{"cannot write PNG file", path, "", image.message};
    write_file({bytes.data(), size}, path);
}

}  // namespace nearfield
