// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/bench_json.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/read_file.h"
#include "formats/model/profile.h"
#include "sample_data/bench/bench_fields.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <type_traits>

namespace nearfield::sample_data {
namespace {

template <typename Enum>
struct Word {
    Enum value;
    const char* text;
};
constexpr std::array<Word<Setup>, 3> kSetups = {
    {{Setup::Filter, "filter"}, {Setup::Pinhole, "pinhole"}, {Setup::Direct, "direct"}}};
constexpr std::array<Word<Mosaic>, 2> kMosaics = {{{Mosaic::Mono, "mono"}, {Mosaic::Rggb, "rggb"}}};
constexpr std::array<Word<BoardPlane>, 3> kPlanes = {
    {{BoardPlane::Screen, "screen"}, {BoardPlane::Filter, "filter"}, {BoardPlane::Free, "free"}}};

constexpr const std::array<Word<Setup>, 3>& words_of(Setup) {
    return kSetups;
}
constexpr const std::array<Word<Mosaic>, 2>& words_of(Mosaic) {
    return kMosaics;
}
constexpr const std::array<Word<BoardPlane>, 3>& words_of(BoardPlane) {
    return kPlanes;
}

template <typename Vector>
Json numbers(const Vector& vector) {
    Json list = Json::array();
    for (int k = 0; k < Vector::length(); ++k)
        list.push_back(vector[k]);
    return list;
}

Json matrix(const glm::dmat3& m) {
    Json list = Json::array();
    for (int k = 0; k < 9; ++k)
        list.push_back(m[k % 3][k / 3]);
    return list;
}

glm::dmat3 matrix(const JsonField& field) {
    const std::vector<double> values = field.numbers(9);
    glm::dmat3 m(0.0);
    for (int k = 0; k < 9; ++k)
        m[k % 3][k / 3] = values[static_cast<std::size_t>(k)];
    return m;
}

class Writer {
  public:
    Json json = Json::object();

    template <typename T>
    void operator()(const char* key, T& member) {
        json[key] = value(member);
    }

  private:
    template <typename T>
    static Json value(T& member) {
        if constexpr (std::is_enum_v<T>) {
            const auto& words = words_of(member);
            return std::find_if(words.begin(), words.end(),
                                [&](const auto& word) { return word.value == member; })
                ->text;
        } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
            return member;
        } else {
            Writer writer;
            visit_fields(writer, member);
            return std::move(writer.json);
        }
    }
    static Json value(glm::dvec2& v) { return numbers(v); }
    static Json value(glm::dvec3& v) { return numbers(v); }
    static Json value(glm::ivec2& v) { return numbers(v); }
    static Json value(glm::dmat3& m) { return matrix(m); }
    static Json value(Rigid& rigid) { return to_json(rigid); }
    static Json value(Profile& profile) {
        const std::vector<std::string> known = model::profile_names();
        if (std::find(known.begin(), known.end(), profile.name) != known.end())
            return profile.name;
        return {{"cells", profile.cells}};
    }
    static Json value(std::vector<TargetView>& views) {
        Json list = Json::array();
        for (TargetView& view : views)
            list.push_back(value(view));
        return list;
    }
};

class Reader {
  public:
    Reader(const Json& json, const std::string& where) : json_(json), where_(where) {
        if (!json.is_object())
            throw Error("bad bench", where, "an object", json_text(json).substr(0, 60));
    }

    template <typename T>
    void operator()(const char* key, T& member) {
        known_.emplace_back(key);
        const auto found = json_.find(key);
        if (found != json_.end())
            read(*found, where_ + "." + key, member);
    }

    /// Throws Error at the first key that nobody asked for.
    void refuse_others() const {
        for (const auto& item : json_.items()) {
            if (std::find(known_.begin(), known_.end(), item.key()) == known_.end()) {
                std::string names;
                for (const std::string& name : known_)
                    names += (names.empty() ? "" : ", ") + name;
                throw Error("bad bench", where_, "one of the keys " + names, item.key());
            }
        }
    }

  private:
    template <typename T>
    static void read(const Json& json, const std::string& where, T& member) {
        const JsonField field(json, where);
        if constexpr (std::is_enum_v<T>) {
            read_word(field, member);
        } else if constexpr (std::is_same_v<T, double>) {
            member = field.number();
        } else if constexpr (std::is_same_v<T, int>) {
            member =
                field.integer(std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
        } else if constexpr (std::is_same_v<T, std::string>) {
            member = field.text();
        } else {
            Reader reader(json, where);
            visit_fields(reader, member);
            reader.refuse_others();
        }
    }
    static void read(const Json& json, const std::string& where, std::uint64_t& seed) {
        if (!json.is_number_unsigned())
            throw Error("bad bench", where, "an integer from 0 to 2^64 - 1",
                        json_text(json).substr(0, 60));
        seed = json.get<std::uint64_t>();
    }
    template <int N, typename T>
    static void read(const Json& json, const std::string& where, glm::vec<N, T>& vector) {
        const std::vector<JsonField> elements =
            JsonField(json, where).elements(static_cast<std::size_t>(N));
        for (int k = 0; k < N; ++k)
            read(json[static_cast<std::size_t>(k)], elements[static_cast<std::size_t>(k)].where(),
                 vector[k]);
    }
    static void read(const Json& json, const std::string& where, glm::dmat3& m) {
        m = matrix(JsonField(json, where));
    }
    static void read(const Json& json, const std::string& where, Rigid& rigid) {
        Reader reader(json, where);
        reader("rotation", rigid.rotation);
        reader("translation_m", rigid.translation_m);
        reader.refuse_others();
    }
    static void read(const Json& json, const std::string& where, Profile& profile) {
        if (json.is_string()) {
            const std::string name = json.get<std::string>();
            const std::vector<std::string> known = model::profile_names();
            if (std::find(known.begin(), known.end(), name) == known.end())
                throw Error("bad bench", where, "box, bilinear, quadratic, bspline or cells", name);
            profile = model::make_profile(name);
            return;
        }
        profile.name = "measured";
        profile.cells.clear();
        for (const JsonField& cell : JsonField(json, where).at("cells").elements()) {
            const std::vector<double> values = cell.numbers(3);
            profile.cells.push_back({values[0], values[1], values[2]});
        }
    }
    static void read(const Json& json, const std::string& where, std::vector<TargetView>& views) {
        views.clear();
        const std::vector<JsonField> elements = JsonField(json, where).elements();
        for (std::size_t k = 0; k < elements.size(); ++k)
            read(json[k], elements[k].where(), views.emplace_back());
    }
    template <typename Enum>
    static void read_word(const JsonField& field, Enum& member) {
        const std::string text = field.text();
        std::string expected;
        for (const auto& word : words_of(member)) {
            if (text == word.text) {
                member = word.value;
                return;
            }
            expected += (expected.empty() ? "" : ", ") + std::string(word.text);
        }
        throw Error("bad bench", field.where(), "one of " + expected, text);
    }

    const Json& json_;
    const std::string& where_;
    std::vector<std::string> known_;
};

}  // namespace

Json to_json(const Rigid& rigid) {
    return {{"rotation", matrix(rigid.rotation)}, {"translation_m", numbers(rigid.translation_m)}};
}

Json to_json(const Bench& bench) {
    Writer writer;
    Bench copy = bench;  // fields are visited for reading and writing alike
    visit_fields(writer, copy);
    return std::move(writer.json);
}

Bench bench_from_json(const Json& json, const std::string& where) {
    Bench bench;
    Reader reader(json, where);
    visit_fields(reader, bench);
    reader.refuse_others();
    return bench;
}

Bench read_bench(const std::string& path) {
    Bench bench = bench_from_json(parse_json(read_file(path), path), path);
    if (!bench.lamp.file.empty())
        bench.lamp.file = (std::filesystem::path(path).parent_path() / bench.lamp.file).string();
    check(bench, path);
    return bench;
}

void write_bench(const Bench& bench, const std::string& path) {
    write_file(to_json(bench).dump(2) + "\n", path);
}

}  // namespace nearfield::sample_data
