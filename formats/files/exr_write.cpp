// SPDX-License-Identifier: Apache-2.0
#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/exr_context.h"
#include "formats/files/exr_stream.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <optional>

namespace nearfield::exr {
namespace {

// Chunks that are compressed side by side.
constexpr std::size_t kBatch = 16;
// Images that are fetched at a time have so many bytes, or are one.
constexpr std::size_t kFetchedBytes = std::size_t{64} << 20U;

struct Output {
    AtomicFile file;
    Messages messages;
    std::optional<Error> failed;  // why a write failed, to be thrown instead of OpenEXR's message
};

int64_t write_bytes(exr_const_context_t,
                    void* user,
                    const void* bytes,
                    uint64_t size,
                    uint64_t offset,
                    exr_stream_error_func_ptr_t) {
    auto* output = static_cast<Output*>(user);
    try {
        output->file.write_at(bytes, size, offset);
        return static_cast<int64_t>(size);
    } catch (const Error& error) {  // must not cross a C library
        output->failed = error;
        return -1;
    }
}

void keep_message(exr_const_context_t context, exr_result_t, const char* message) {
    void* user = nullptr;
    if (context != nullptr && exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user)
        static_cast<Output*>(user)->messages.keep(message);
}

/// An EXR file being written.
class Writer {
  public:
    explicit Writer(const std::string& path) : path_(path), output_{AtomicFile(path), {}, {}} {
        exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
        setup.error_handler_fn = keep_message;
        setup.user_data = &output_;
        setup.write_fn = write_bytes;
        setup.max_image_width = setup.max_image_height = kMaxImage_px;
        setup.max_tile_width = setup.max_tile_height = kMaxTile_px;
        verify(exr_start_write(&context_, path.c_str(), EXR_WRITE_FILE_DIRECTLY, &setup));
    }
    ~Writer() { exr_finish(&context_); }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    void add(const Atlas<const float>& atlas, Compression compression);
    void set(const Attributes& attributes);
    void write_header() { verify(exr_write_header(context_)); }
    void write_part(int part, const Atlas<const float>& atlas);
    /// A tiled atlas whose images are fetched: (plane, image, values).
    void write_part_fetched(int part,
                            const Atlas<const float>& atlas,
                            const std::function<void(std::size_t, int, float*)>& fetch);
    void finish();

  private:
    // A chunk and where its pixels are.
    struct Piece {
        const Atlas<const float>* atlas = nullptr;
        Chunk chunk;
    };
    void write_pieces(int part, const std::vector<Piece>& pieces);
    void verify(exr_result_t result) {
        if (output_.failed)
            throw Error{*output_.failed};
        if (result != EXR_ERR_SUCCESS)
            throw Error{"cannot write EXR file", path_, "", output_.messages.take(result)};
    }
    exr_result_t encode(exr_encode_pipeline_t& pipeline,
                        int part,
                        const Atlas<const float>& atlas,
                        const Chunk& chunk);

    std::string path_;
    Output output_;
    exr_context_t context_ = nullptr;
    exr_attr_box2i_t display_{};
};

void Writer::add(const Atlas<const float>& atlas, Compression compression) {
    const glm::i64vec2 size = glm::i64vec2(atlas.grid) * glm::i64vec2(atlas.image);
    if (std::max(size.x, size.y) > kMaxImage_px ||
        (atlas.is_tiled && std::max(atlas.image.x, atlas.image.y) > kMaxTile_px))
        throw Error{
            "part " + atlas.part + " is too large", path_,
            fmt::format("at most {} pixels an edge, {} an image", kMaxImage_px, kMaxTile_px),
            fmt::format("{} x {}, images {} x {}", size.x, size.y, atlas.image.x, atlas.image.y)};
    int part = 0;
    verify(exr_add_part(context_, atlas.part.c_str(),
                        atlas.is_tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &part));
    const auto window = [](glm::i64vec2 extent) {
        return exr_attr_box2i_t{
            {0, 0}, {static_cast<int32_t>(extent.x - 1), static_cast<int32_t>(extent.y - 1)}};
    };
    // Readers refuse files whose parts disagree about the display window.
    if (part == 0)
        display_ = window(size);
    const exr_attr_box2i_t data = window(size);
    const exr_attr_v2f_t center{0.0F, 0.0F};
    verify(exr_initialize_required_attr(
        context_, part, &display_, &data, 1.0F, &center, 1.0F, EXR_LINEORDER_INCREASING_Y,
        compression == Compression::Zip ? EXR_COMPRESSION_ZIP : EXR_COMPRESSION_NONE));
    if (atlas.is_tiled)
        verify(exr_set_tile_descriptor(context_, part, static_cast<uint32_t>(atlas.image.x),
                                       static_cast<uint32_t>(atlas.image.y), EXR_TILE_ONE_LEVEL,
                                       EXR_TILE_ROUND_DOWN));
    for (const Plane<const float>& plane : atlas.planes)
        verify(exr_add_channel(context_, part, plane.channel.c_str(), EXR_PIXEL_FLOAT,
                               EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
}

void Writer::set(const Attributes& attributes) {
    for (const auto& [name, text] : attributes)
        verify(exr_attr_set_string(context_, 0, name.c_str(), text.c_str()));
}

exr_result_t Writer::encode(exr_encode_pipeline_t& pipeline,
                            int part,
                            const Atlas<const float>& atlas,
                            const Chunk& chunk) {
    exr_chunk_info_t info;
    exr_result_t result =
        atlas.is_tiled
            ? exr_write_tile_chunk_info(context_, part, chunk.tile_x, chunk.tile_y, 0, 0, &info)
            : exr_write_scanline_chunk_info(context_, part, chunk.row, &info);
    if (result == EXR_ERR_SUCCESS)
        result = exr_encoding_initialize(context_, part, &info, &pipeline);
    if (result != EXR_ERR_SUCCESS)
        return result;
    for (int c = 0; c < pipeline.channel_count; ++c) {
        exr_coding_channel_info_t& channel = pipeline.channels[c];
        const auto plane =
            std::find_if(atlas.planes.begin(), atlas.planes.end(),
                         [&](const auto& p) { return p.channel == channel.channel_name; });
        set_strides(channel, *plane);
        channel.encode_from_ptr = reinterpret_cast<const uint8_t*>(origin(atlas, *plane, chunk));
    }
    result = exr_encoding_choose_default_routines(context_, part, &pipeline);
    pipeline.yield_until_ready_fn = nullptr;  // written in order by write_part
    pipeline.write_fn = nullptr;
    return result == EXR_ERR_SUCCESS ? exr_encoding_run(context_, part, &pipeline) : result;
}

struct EncodedBytes {
    const void* data;
    std::uint64_t size;
};

/// A chunk that compression would not make smaller is stored as it is; OpenEXR 3.1.5 gives it that
/// size and leaves the compressed bytes, cut off, in its place.
EncodedBytes encoded_bytes(const exr_encode_pipeline_t& done) {
    if (done.compressed_bytes < done.packed_bytes)
        return {done.compressed_buffer, done.compressed_bytes};
    return {done.packed_buffer, done.packed_bytes};
}

void Writer::write_pieces(int part, const std::vector<Piece>& pieces) {
    // Compress side by side, then write in order.
    std::vector<exr_encode_pipeline_t> pipelines(pieces.size());
    std::vector<exr_result_t> results(pieces.size(), EXR_ERR_SUCCESS);
    tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t k) {
        results[k] = encode(pipelines[k], part, *pieces[k].atlas, pieces[k].chunk);
    });
    exr_result_t result = EXR_ERR_SUCCESS;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        const Chunk& chunk = pieces[k].chunk;
        const EncodedBytes bytes = encoded_bytes(pipelines[k]);
        if (result == EXR_ERR_SUCCESS)
            result = results[k];
        if (result == EXR_ERR_SUCCESS)
            result =
                pieces[k].atlas->is_tiled
                    ? exr_write_tile_chunk(context_, part, chunk.tile_x, chunk.tile_y, 0, 0,
                                           bytes.data, bytes.size)
                    : exr_write_scanline_chunk(context_, part, chunk.row, bytes.data, bytes.size);
    }
    for (exr_encode_pipeline_t& pipeline : pipelines)
        exr_encoding_destroy(context_, &pipeline);
    verify(result);
}

void Writer::write_part(int part, const Atlas<const float>& atlas) {
    int rows_per_chunk = atlas.image.y;
    if (!atlas.is_tiled)
        verify(exr_get_scanlines_per_chunk(context_, part, &rows_per_chunk));
    const std::size_t count = chunk_count(atlas, rows_per_chunk);
    for (std::size_t begin = 0; begin < count; begin += kBatch) {
        std::vector<Piece> pieces;
        for (std::size_t k = begin; k < std::min(begin + kBatch, count); ++k)
            pieces.push_back({&atlas, chunk_at(atlas, k, rows_per_chunk)});
        write_pieces(part, pieces);
    }
}

void Writer::write_part_fetched(int part,
                                const Atlas<const float>& atlas,
                                const std::function<void(std::size_t, int, float*)>& fetch) {
    const std::size_t pixels =
        static_cast<std::size_t>(atlas.image.x) * static_cast<std::size_t>(atlas.image.y);
    const std::size_t image_values = pixels * atlas.planes.size();
    const std::size_t batch =
        std::clamp<std::size_t>(kFetchedBytes / (image_values * sizeof(float)), 1, kBatch);
    const std::size_t count = chunk_count(atlas, atlas.image.y);
    std::vector<float> values(image_values * std::min(batch, count));
    for (std::size_t begin = 0; begin < count; begin += batch) {
        const std::size_t size = std::min(batch, count - begin);
        // Each image's planes as if all images of the atlas were this one.
        std::vector<Atlas<const float>> fetched(size, atlas);
        std::vector<Piece> pieces;
        for (std::size_t k = 0; k < size; ++k) {
            const Chunk chunk = chunk_at(atlas, begin + k, atlas.image.y);
            for (std::size_t plane = 0; plane < atlas.planes.size(); ++plane) {
                float* const to = &values[k * image_values + plane * pixels];
                fetch(plane, image_at(atlas, chunk), to);
                Plane<const float>& here = fetched[k].planes[plane];
                here = upright<const float>(here.channel, to, atlas.image);
                here.image_stride = 0;
            }
            pieces.push_back({&fetched[k], chunk});
        }
        write_pieces(part, pieces);
    }
}

void Writer::finish() {
    verify(exr_finish(&context_));  // writes the chunk tables
    output_.file.commit();
}

}  // namespace

void write(const std::vector<Atlas<const float>>& atlases,
           Compression compression,
           const Attributes& attributes,
           const std::string& path) {
    Writer writer(path);
    for (const Atlas<const float>& atlas : atlases)
        writer.add(atlas, compression);
    writer.set(attributes);
    writer.write_header();
    for (std::size_t part = 0; part < atlases.size(); ++part)
        writer.write_part(static_cast<int>(part), atlases[part]);
    writer.finish();
}

void write_fetched(const std::vector<Atlas<const float>>& atlases,
                   const FetchImage& fetch,
                   Compression compression,
                   const Attributes& attributes,
                   const std::string& path) {
    Writer writer(path);
    for (const Atlas<const float>& atlas : atlases)
        writer.add(atlas, compression);
    writer.set(attributes);
    writer.write_header();
    for (std::size_t part = 0; part < atlases.size(); ++part)
        writer.write_part_fetched(static_cast<int>(part), atlases[part],
                                  [&](std::size_t plane, int image, float* values) {
                                      fetch(part, plane, image, values);
                                  });
    writer.finish();
}

}  // namespace nearfield::exr
