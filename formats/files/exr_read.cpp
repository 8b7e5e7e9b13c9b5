// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/files/exr_context.h"
#include "formats/files/exr_input.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>

namespace nearfield::exr {
namespace {

/// How many bytes one byte of the file can unpack to: deflate at most 1032, RLE 128 from 2.
std::optional<std::uint64_t> largest_expansion(int compression) {
    switch (compression) {
        case EXR_COMPRESSION_NONE:
            return 1;
        case EXR_COMPRESSION_RLE:
            return 64;
        case EXR_COMPRESSION_ZIPS:
        case EXR_COMPRESSION_ZIP:
            return 1032;
        default:
            return std::nullopt;
    }
}

std::string shape_text(glm::i64vec2 size, glm::ivec2 tile) {
    return tile.x == 0 ? fmt::format("{} x {} scanlines", size.x, size.y)
                       : fmt::format("{} x {} in tiles of {} x {}", size.x, size.y, tile.x, tile.y);
}

std::string names_text(std::vector<std::string> names) {
    std::sort(names.begin(), names.end());
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ", ") + name;
    return text;
}

/// The first error of many chunks, whatever the order in which threads meet them.
class FirstError {
  public:
    void keep(std::size_t index, Error error) {
        const std::lock_guard lock(mutex_);
        errors_.emplace(index, std::move(error));
        if (errors_.size() > 1)
            errors_.erase(std::prev(errors_.end()));
    }
    void rethrow() const {
        if (!errors_.empty())
            throw Error{errors_.begin()->second};
    }

  private:
    std::mutex mutex_;
    std::map<std::size_t, Error> errors_;
};

bool all_valid(const float* row, std::ptrdiff_t stride, int count, Values values) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    const float least = values == Values::NonNegative ? 0.0F : -kLargest;
    const auto is_bad = [least](float value) {
        return static_cast<int>(!(value >= least)) | static_cast<int>(!(value <= kLargest));
    };
    int bad = 0;
    if (stride == 1)  // apart, since only this loop becomes SIMD: a quarter of the reading time
        for (int i = 0; i < count; ++i)
            bad |= is_bad(row[i]);
    else
        for (int i = 0; i < count; ++i)
            bad |= is_bad(row[i * stride]);
    return bad == 0;
}

}  // namespace

struct Reader::State {
    Input input;
    exr_context_t context = nullptr;
    double claimed_bytes = 0;  // least share of the file that the required parts need

    explicit State(const std::string& path) : input(path) {}
    ~State() { exr_finish(&context); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    void verify(exr_result_t result, const std::string& where) {
        if (result != EXR_ERR_SUCCESS)
            throw Error{"cannot read EXR file", where, "", input.messages.take(result)};
    }
    std::string place(const std::string& part) const { return input.path + ", part " + part; }
    int index_of(const std::string& name) const;
    std::vector<const Plane<float>*> raw_planes(const Part& part, const Atlas<float>& atlas) const;
    exr_result_t chunk_info(int part,
                            const Atlas<float>& atlas,
                            const Chunk& chunk,
                            exr_chunk_info_t& info) const;
    exr_result_t decode(exr_decode_pipeline_t& pipeline,
                        int part,
                        const Atlas<float>& atlas,
                        const Chunk& chunk,
                        int& row_count);
    exr_result_t copy(std::vector<float>& packed,
                      int part,
                      const Atlas<float>& atlas,
                      const std::vector<const Plane<float>*>& planes,
                      const Chunk& chunk,
                      int& row_count) const;
    void check_values(const Atlas<float>& atlas, const Chunk& chunk, int row_count) const;
};

int Reader::State::index_of(const std::string& name) const {
    int count = 0;
    exr_get_count(context, &count);
    for (int index = 0; index < count; ++index) {
        const char* found = nullptr;
        if (exr_get_name(context, index, &found) == EXR_ERR_SUCCESS && found != nullptr &&
            name == found)
            return index;
    }
    return -1;
}

// An atlas' planes in the order of the file's channels where the part holds uncompressed floats,
// else nothing.
std::vector<const Plane<float>*> Reader::State::raw_planes(const Part& part,
                                                           const Atlas<float>& atlas) const {
    if (part.compression != EXR_COMPRESSION_NONE ||
        part.pixel_bytes != static_cast<int>(part.channels.size() * sizeof(float)))
        return {};
    std::vector<const Plane<float>*> planes;
    for (const std::string& channel : part.channels)
        planes.push_back(&*std::find_if(atlas.planes.begin(), atlas.planes.end(),
                                        [&](const auto& p) { return p.channel == channel; }));
    return planes;
}

exr_result_t Reader::State::chunk_info(int part,
                                       const Atlas<float>& atlas,
                                       const Chunk& chunk,
                                       exr_chunk_info_t& info) const {
    if (atlas.is_tiled)
        return exr_read_tile_chunk_info(context, part, chunk.tile_x, chunk.tile_y, 0, 0, &info);
    exr_attr_box2i_t window;
    const exr_result_t result = exr_get_data_window(context, part, &window);
    return result == EXR_ERR_SUCCESS
               ? exr_read_scanline_chunk_info(context, part, window.min.y + chunk.row, &info)
               : result;
}

exr_result_t Reader::State::decode(exr_decode_pipeline_t& pipeline,
                                   int part,
                                   const Atlas<float>& atlas,
                                   const Chunk& chunk,
                                   int& row_count) {
    exr_chunk_info_t info;
    exr_result_t result = chunk_info(part, atlas, chunk, info);
    if (result != EXR_ERR_SUCCESS)
        return result;
    if (info.width != atlas.image.x || info.height > atlas.image.y - chunk.row ||
        info.packed_size > input.size)
        return EXR_ERR_BAD_CHUNK_LEADER;
    row_count = info.height;

    const bool is_first = pipeline.context == nullptr;
    result = is_first ? exr_decoding_initialize(context, part, &info, &pipeline)
                      : exr_decoding_update(context, part, &info, &pipeline);
    if (result != EXR_ERR_SUCCESS)
        return result;
    for (int c = 0; c < pipeline.channel_count; ++c) {
        exr_coding_channel_info_t& channel = pipeline.channels[c];
        const auto plane =
            std::find_if(atlas.planes.begin(), atlas.planes.end(),
                         [&](const auto& p) { return p.channel == channel.channel_name; });
        set_strides(channel, *plane);
        channel.decode_to_ptr = reinterpret_cast<uint8_t*>(origin(atlas, *plane, chunk));
    }
    if (is_first)
        result = exr_decoding_choose_default_routines(context, part, &pipeline);
    return result == EXR_ERR_SUCCESS ? exr_decoding_run(context, part, &pipeline) : result;
}

// Uncompressed floats, read in one piece: OpenEXR's pipeline makes a system call for every row of
// every channel. A chunk holds its rows one after the other, in each the channels one after the
// other.
exr_result_t Reader::State::copy(std::vector<float>& packed,
                                 int part,
                                 const Atlas<float>& atlas,
                                 const std::vector<const Plane<float>*>& planes,
                                 const Chunk& chunk,
                                 int& row_count) const {
    exr_chunk_info_t info;
    exr_result_t result = chunk_info(part, atlas, chunk, info);
    if (result != EXR_ERR_SUCCESS)
        return result;
    const auto width = static_cast<std::size_t>(atlas.image.x);
    const std::size_t row_values = width * planes.size();
    if (info.width != atlas.image.x || info.height > atlas.image.y - chunk.row ||
        info.packed_size != row_values * static_cast<std::size_t>(info.height) * sizeof(float) ||
        info.packed_size > input.size)
        return EXR_ERR_BAD_CHUNK_LEADER;
    row_count = info.height;
    packed.resize(row_values * static_cast<std::size_t>(info.height));
    result = exr_read_chunk(context, part, &info, packed.data());
    if (result != EXR_ERR_SUCCESS)
        return result;
    const float* from = packed.data();
    for (int row = 0; row < info.height; ++row)
        for (const Plane<float>* plane : planes) {
            float* to = origin(atlas, *plane, chunk) + row * plane->row_stride;
            if (plane->column_stride == 1)
                std::memcpy(to, from, width * sizeof(float));
            else
                for (std::size_t i = 0; i < width; ++i)
                    to[static_cast<std::ptrdiff_t>(i) * plane->column_stride] = from[i];
            from += width;
        }
    return result;
}

void Reader::State::check_values(const Atlas<float>& atlas,
                                 const Chunk& chunk,
                                 int row_count) const {
    for (const Plane<float>& plane : atlas.planes) {
        const float* first = origin(atlas, plane, chunk);
        for (int row = 0; row < row_count; ++row) {
            const float* values = first + row * plane.row_stride;
            if (all_valid(values, plane.column_stride, atlas.image.x, atlas.values))
                continue;
            int i = 0;
            while (all_valid(values + i * plane.column_stride, 1, 1, atlas.values))
                ++i;
            throw Error{"bad value",
                        fmt::format("{}, image {}, texel ({}, {}), channel {}", place(atlas.part),
                                    image_at(atlas, chunk), i, atlas.image.y - 1 - chunk.row - row,
                                    plane.channel),
                        atlas.values == Values::NonNegative ? "finite and >= 0" : "finite",
                        fmt::format("{}", values[i * plane.column_stride])};
        }
    }
}

Reader::Reader(const std::string& path) : state_(std::make_unique<State>(path)) {
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = keep_message;
    setup.alloc_fn = allocate;
    setup.free_fn = std::free;
    setup.user_data = &state_->input;
    setup.read_fn = read_bytes;
    setup.size_fn = query_size;
    setup.max_image_width = setup.max_image_height = kMaxImage_px;
    setup.max_tile_width = setup.max_tile_height = kMaxTile_px;
    // Part and attribute lists grow in small steps; 64 KiB covers what does not lie in the file.
    const LimitAllocations limit(state_->input.size + 65536);
    state_->verify(exr_start_read(&state_->context, path.c_str(), &setup), path);
}

Reader::~Reader() = default;

int Reader::part_count() const {
    int count = 0;
    state_->verify(exr_get_count(state_->context, &count), state_->input.path);
    return count;
}

Part Reader::part(int index) const {
    const std::string where = fmt::format("{}, part {}", state_->input.path, index);
    Part part;
    const char* name = nullptr;
    if (exr_get_name(state_->context, index, &name) == EXR_ERR_SUCCESS && name != nullptr)
        part.name = name;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    state_->verify(exr_get_storage(state_->context, index, &storage), where);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        throw Error{"unsupported part", where, "scanlines or tiles", "deep data"};
    exr_attr_box2i_t window;
    state_->verify(exr_get_data_window(state_->context, index, &window), where);
    part.size = {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
    if (storage == EXR_STORAGE_TILED) {
        uint32_t width = 0, height = 0;
        exr_tile_level_mode_t level = EXR_TILE_LAST_TYPE;
        exr_tile_round_mode_t round = EXR_TILE_ROUND_LAST_TYPE;
        state_->verify(
            exr_get_tile_descriptor(state_->context, index, &width, &height, &level, &round),
            where);
        if (level != EXR_TILE_ONE_LEVEL)
            throw Error{"unsupported part", where, "one resolution level", "several"};
        part.tile = {static_cast<int>(width), static_cast<int>(height)};
    }
    exr_compression_t compression = EXR_COMPRESSION_LAST_TYPE;
    state_->verify(exr_get_compression(state_->context, index, &compression), where);
    part.compression = static_cast<int>(compression);
    const exr_attr_chlist_t* channels = nullptr;
    state_->verify(exr_get_channels(state_->context, index, &channels), where);
    for (int c = 0; c < channels->num_channels; ++c) {
        const exr_attr_chlist_entry_t& entry = channels->entries[c];
        if (entry.pixel_type == EXR_PIXEL_UINT || entry.x_sampling != 1 || entry.y_sampling != 1)
            throw Error{"unsupported channel", where + ", channel " + entry.name.str,
                        "float or half at every pixel", "integers or subsampled"};
        part.channels.emplace_back(entry.name.str);
        part.pixel_bytes += entry.pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    }
    return part;
}

bool Reader::has_part(const std::string& name) const {
    return state_->index_of(name) >= 0;
}

std::optional<std::string> Reader::attribute(const std::string& name) const {
    const exr_attribute_t* found = nullptr;
    if (exr_get_attribute_by_name(state_->context, 0, name.c_str(), &found) != EXR_ERR_SUCCESS) {
        state_->input.messages.take(EXR_ERR_SUCCESS);
        return std::nullopt;
    }
    if (found->type != EXR_ATTR_STRING)
        throw Error{"wrong attribute type", state_->input.path + ", " + name, "string",
                    found->type_name};
    return std::string(found->string->str, static_cast<std::size_t>(found->string->length));
}

void Reader::require(const Atlas<float>& shape) {
    const std::string where = state_->place(shape.part);
    const int index = state_->index_of(shape.part);
    if (index < 0)
        throw Error{"missing part", where};
    const Part found = part(index);
    const glm::i64vec2 size = glm::i64vec2(shape.grid) * glm::i64vec2(shape.image);
    const glm::ivec2 tile = shape.is_tiled ? shape.image : glm::ivec2(0);
    if (glm::i64vec2(found.size) != size || found.tile != tile)
        throw Error{"wrong size", where, shape_text(size, tile),
                    shape_text(found.size, found.tile)};
    std::vector<std::string> channels;
    for (const Plane<float>& plane : shape.planes)
        channels.push_back(plane.channel);
    if (names_text(channels) != names_text(found.channels))
        throw Error{"wrong channels", where, names_text(channels), names_text(found.channels)};

    const std::optional<std::uint64_t> expansion = largest_expansion(found.compression);
    if (!expansion)
        throw Error{"unsupported compression", where, "none, RLE, ZIPS or ZIP"};
    const double bytes =
        static_cast<double>(size.x) * static_cast<double>(size.y) * found.pixel_bytes;
    state_->claimed_bytes += bytes / static_cast<double>(*expansion);
    if (state_->claimed_bytes > static_cast<double>(state_->input.size))
        throw Error{"file is too small for its header", where,
                    fmt::format("{:.0f} bytes at least", state_->claimed_bytes),
                    fmt::format("{} bytes", state_->input.size)};
}

void Reader::read(const Atlas<float>& atlas) const {
    const int index = state_->index_of(atlas.part);
    int rows_per_chunk = atlas.image.y;
    if (!atlas.is_tiled)
        state_->verify(exr_get_scanlines_per_chunk(state_->context, index, &rows_per_chunk),
                       state_->place(atlas.part));
    const std::size_t count = chunk_count(atlas, rows_per_chunk);
    {
        // The first look-up loads the part's table of chunks.
        const LimitAllocations limit(state_->input.size);
        exr_chunk_info_t info;
        state_->verify(state_->chunk_info(index, atlas, chunk_at(atlas, 0, rows_per_chunk), info),
                       state_->place(atlas.part));
    }
    const std::vector<const Plane<float>*> raw_planes = state_->raw_planes(part(index), atlas);
    FirstError first_error;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4), [&](const auto& range) {
        exr_decode_pipeline_t pipeline{};
        std::vector<float> packed;
        for (std::size_t k = range.begin(); k < range.end(); ++k) {
            const Chunk chunk = chunk_at(atlas, k, rows_per_chunk);
            try {
                int row_count = 0;
                const exr_result_t result =
                    raw_planes.empty()
                        ? state_->decode(pipeline, index, atlas, chunk, row_count)
                        : state_->copy(packed, index, atlas, raw_planes, chunk, row_count);
                state_->verify(result, fmt::format("{}, chunk {}", state_->place(atlas.part), k));
                if (atlas.values != Values::Any)
                    state_->check_values(atlas, chunk, row_count);
            } catch (const Error& error) {
                first_error.keep(k, error);
            }
        }
        exr_decoding_destroy(state_->context, &pipeline);
    });
    first_error.rethrow();
}

}  // namespace nearfield::exr
