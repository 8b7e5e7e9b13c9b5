// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/gltf_accessor.h"

#include "formats/files/error.h"
#include "formats/scene/gltf_guard.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>

namespace nearfield::gltf {
namespace {

/// A checked accessor: element i begins at data + i * stride and lies within the buffer.
struct Elements {
    const unsigned char* data = nullptr;
    std::size_t count = 0, stride = 0;
    int component_type = 0;
};

template <typename T>
const T& at(const std::vector<T>& list, int index, const char* name, const std::string& where) {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size())
        throw Error{kReadingScene, where, fmt::format("an index into {} {}", list.size(), name),
                    fmt::format("{}", index)};
    return list[static_cast<std::size_t>(index)];
}

std::size_t component_bytes(int component_type) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        default:
            return 4;
    }
}

Elements elements(const tinygltf::Model& model,
                  int index,
                  std::size_t components,
                  const std::string& where) {
    const auto& accessor = at(model.accessors, index, "accessors", where);
    const std::string place = fmt::format("{} (accessors[{}])", where, index);
    if (accessor.sparse.isSparse)
        throw Error{kReadingScene, place, "an accessor that is not sparse", "a sparse one"};
    const auto& view = at(model.bufferViews, accessor.bufferView, "bufferViews", place);
    const auto& buffer = at(model.buffers, view.buffer, "buffers", place);

    // Sizes are below 2^31 each (gltf_guard.cpp), so that sums and products fit 64 bits.
    const std::size_t element = components * component_bytes(accessor.componentType);
    const std::size_t stride = view.byteStride == 0 ? element : view.byteStride;
    if (view.byteOffset + view.byteLength > buffer.data.size())
        throw Error{kReadingScene, fmt::format("{}, bufferViews[{}]", place, accessor.bufferView),
                    fmt::format("bytes within the buffer's {}", buffer.data.size()),
                    fmt::format("{} + {}", view.byteOffset, view.byteLength)};
    if (accessor.count == 0 || stride < element ||
        accessor.byteOffset + stride * (accessor.count - 1) + element > view.byteLength)
        throw Error{kReadingScene, place,
                    fmt::format("elements of {} bytes within {} bytes of bufferViews[{}]", element,
                                view.byteLength, accessor.bufferView),
                    fmt::format("{} elements every {} bytes from {}", accessor.count, stride,
                                accessor.byteOffset)};
    return {buffer.data.data() + view.byteOffset + accessor.byteOffset, accessor.count, stride,
            accessor.componentType};
}

template <typename Vector>
std::vector<Vector> read_vectors(const tinygltf::Model& model,
                                 int accessor,
                                 const std::string& where) {
    // Beyond this the ray tracer ignores triangles.
    constexpr float kLargest = 1e9F;

    const Elements source =
        elements(model, accessor, static_cast<std::size_t>(Vector::length()), where);
    if (source.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT ||
        model.accessors[static_cast<std::size_t>(accessor)].type != Vector::length())
        throw Error{kReadingScene, where,
                    fmt::format("an accessor of VEC{} of float (5126)", Vector::length()),
                    fmt::format("component type {}", source.component_type)};
    std::vector<Vector> values(source.count);
    for (std::size_t i = 0; i < source.count; ++i) {
        std::memcpy(&values[i], source.data + i * source.stride, sizeof(Vector));
        for (int axis = 0; axis < Vector::length(); ++axis)
            if (!(std::abs(values[i][axis]) <= kLargest))
                throw Error{kReadingScene, fmt::format("{}, element {}", where, i),
                            fmt::format("numbers from {:g} to {:g}", -kLargest, kLargest),
                            fmt::format("{}", values[i][axis])};
    }
    return values;
}

// read_vectors compares the library's codes with the number of components.
static_assert(TINYGLTF_TYPE_VEC3 == 3 && TINYGLTF_TYPE_VEC4 == 4);

}  // namespace

std::vector<glm::vec3> read_vec3(const tinygltf::Model& model,
                                 int accessor,
                                 const std::string& where) {
    return read_vectors<glm::vec3>(model, accessor, where);
}

std::vector<glm::vec4> read_vec4(const tinygltf::Model& model,
                                 int accessor,
                                 const std::string& where) {
    return read_vectors<glm::vec4>(model, accessor, where);
}

std::vector<std::uint32_t> read_indices(const tinygltf::Model& model,
                                        int accessor,
                                        std::size_t limit,
                                        const std::string& where) {
    const Elements source = elements(model, accessor, 1, where);
    const bool is_integer = source.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                            source.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                            source.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!is_integer ||
        model.accessors[static_cast<std::size_t>(accessor)].type != TINYGLTF_TYPE_SCALAR)
        throw Error{kReadingScene, where,
                    "an accessor of SCALAR of unsigned integers (5121, 5123, 5125)",
                    fmt::format("component type {}", source.component_type)};
    std::vector<std::uint32_t> values(source.count);
    for (std::size_t i = 0; i < source.count; ++i) {
        // Little endian, as is every machine that this program is built for.
        std::memcpy(&values[i], source.data + i * source.stride,
                    component_bytes(source.component_type));
        if (values[i] >= limit)
            throw Error{kReadingScene, fmt::format("{}, element {}", where, i),
                        fmt::format("an index below {}", limit), fmt::format("{}", values[i])};
    }
    return values;
}

}  // namespace nearfield::gltf
