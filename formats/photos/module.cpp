// SPDX-License-Identifier: Apache-2.0
#include "formats/photos/module.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

using nearfield::photos::Photo, nearfield::photos::RadiancePicture;

constexpr double kMostPixels = 1U << 28U;

std::optional<double> positive(const OIIO::ImageSpec& spec, const char* name) {
    const float value = spec.get_float_attribute(name, 0);
    return value > 0 && std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

// Raw files stay the sensor's mosaic: colors are made where the response is known.
OIIO::ImageSpec raw_as_it_is() {
    OIIO::ImageSpec config;
    config.attribute("raw:Demosaic", "none");
    config.attribute("raw:ColorSpace", "raw");
    config.attribute("raw:use_camera_wb", 0);
    return config;
}

void describe(const OIIO::ImageInput& input, Photo& photo) {
    const OIIO::ImageSpec& spec = input.spec();
    photo.format = input.format_name();
    photo.is_linear = photo.format == "raw";
    photo.make = spec.get_string_attribute("Make");
    photo.model = spec.get_string_attribute("Model");
    if (const std::optional<double> seconds = positive(spec, "ExposureTime"))
        photo.exposure_us = *seconds * 1e6;
    photo.f_number = positive(spec, "FNumber");
    photo.iso = positive(spec, "Exif:PhotographicSensitivity");
}

bool is_absurd(const OIIO::ImageSpec& spec) {
    return spec.width < 1 || spec.height < 1 || spec.depth > 1 ||
           static_cast<double>(spec.width) * spec.height > kMostPixels;
}

std::string complaint_about(const OIIO::ImageSpec& spec) {
    if (spec.format.is_floating_point())
        return "floating point values";
    return is_absurd(spec) ? "an absurd size" : "";
}

void keep_colors(const std::vector<std::uint16_t>& values, int channels, Photo& photo) {
    const int kept = channels < 3 ? 1 : 3;
    photo.frame.channels = kept;
    const std::size_t pixels = values.size() / static_cast<std::size_t>(channels);
    photo.frame.values.reserve(pixels * static_cast<std::size_t>(kept));
    for (std::size_t k = 0; k < pixels; ++k)
        for (int c = 0; c < kept; ++c)
            photo.frame.values.push_back(
                values[k * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)]);
}

bool read(const std::string& path, Photo& photo, std::string& complaint) {
    const OIIO::ImageSpec config = raw_as_it_is();
    const auto input = OIIO::ImageInput::open(path, &config);
    if (!input) {
        complaint = OIIO::geterror();
        return false;
    }
    const OIIO::ImageSpec spec = input->spec();
    complaint = complaint_about(spec);
    if (!complaint.empty())
        return false;
    describe(*input, photo);
    const bool is_8_bit = spec.format.size() == 1;
    photo.frame.size_px = {spec.width, spec.height};
    photo.frame.bits = is_8_bit ? 8 : 16;
    std::vector<std::uint16_t> values(spec.image_pixels() *
                                      static_cast<std::size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT16, values.data())) {
        complaint = input->geterror();
        return false;
    }
    if (is_8_bit)  // OpenImageIO spreads 8 bits over 16: 255 becomes 65535
        std::for_each(values.begin(), values.end(), [](std::uint16_t& value) {
            value = static_cast<std::uint16_t>(value >> 8U);
        });
    keep_colors(values, spec.nchannels, photo);
    return true;
}

bool read_light(const std::string& path, RadiancePicture& picture, std::string& complaint) {
    const auto input = OIIO::ImageInput::open(path);
    if (!input) {
        complaint = OIIO::geterror();
        return false;
    }
    const OIIO::ImageSpec spec = input->spec();
    if (std::string(input->format_name()) != "hdr" || is_absurd(spec)) {
        complaint = is_absurd(spec) ? "an absurd size" : input->format_name();
        return false;
    }
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    std::vector<float> values(spec.image_pixels() * channels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data())) {
        complaint = input->geterror();
        return false;
    }
    picture.size_px = {spec.width, spec.height};
    picture.rgb.reserve(spec.image_pixels());
    for (std::size_t k = 0; k < values.size(); k += channels)
        picture.rgb.push_back(channels < 3 ? glm::vec3(values[k])
                                           : glm::vec3(values[k], values[k + 1], values[k + 2]));
    return true;
}

}  // namespace

extern "C" bool nearfield_read_photo(const std::string& path,
                                     Photo& photo,
                                     std::string& complaint) {
    try {
        return read(path, photo, complaint);
    } catch (const std::exception& error) {
        complaint = error.what();
        return false;
    }
}

extern "C" bool nearfield_read_radiance(const std::string& path,
                                        RadiancePicture& picture,
                                        std::string& complaint) {
    try {
        return read_light(path, picture, complaint);
    } catch (const std::exception& error) {
        complaint = error.what();
        return false;
    }
}
