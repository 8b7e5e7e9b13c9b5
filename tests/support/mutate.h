// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

namespace nearfield::test {

/// How many mutations a fuzz test tries: NEARFIELD_FUZZ_COUNT, 1000 where it is not set.
inline std::uint64_t fuzz_count() {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): no test sets environment variables.
    const char* text = std::getenv("NEARFIELD_FUZZ_COUNT");
    return text == nullptr ? 1000 : std::strtoull(text, nullptr, 10);
}

namespace mutate_detail {

/// Values at which size and sign arithmetic breaks.
constexpr std::array<std::uint64_t, 14> kExtremes = {
    0,           1,
    0x7F,        0x80,
    0xFF,        0x7FFF,
    0xFFFF,      0x7FFFFFFF,
    0x80000000,  0xFFFFFFFF,
    0x100000000, 0x7FFFFFFFFFFFFFFF,
    0x7FC00000,  0xFFFFFFFFFFFFFFFF,  // 0x7FC00000: a float's NaN
};

/// What a JSON, XML or CSV parser may stumble over.
inline const std::array<std::string, 14> kTokens = {
    "-1", "0",  "1e999", "nan", "-inf", "99999999999999999999", "null",
    "{",  "[[", "\"",    ",,",  "\n",   std::string(1, '\0'),   "\xFF\xFE"};

inline void mutate_once(std::string& bytes, std::mt19937_64& random) {
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
    const std::size_t at = below(bytes.size());
    switch (random() % 9) {
        case 0:  // flip a bit
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
            break;
        case 1:  // another byte
            bytes[at] = static_cast<char>(random());
            break;
        case 2:  // cut the end off
            bytes.resize(at);
            break;
        case 3:  // take a block out
            bytes.erase(at, 1 + below(64));
            break;
        case 4:  // repeat a block elsewhere
            bytes.insert(below(bytes.size()), bytes.substr(at, 1 + below(64)));
            break;
        case 5: {  // swap two blocks
            const std::size_t size = 1 + below(32), other = below(bytes.size());
            for (std::size_t k = 0; k < size && std::max(at, other) + k < bytes.size(); ++k)
                std::swap(bytes[at + k], bytes[other + k]);
            break;
        }
        case 6:
        case 7: {  // a little-endian integer of 1, 2, 4 or 8 bytes
            const std::uint64_t value = kExtremes[below(kExtremes.size())];
            const std::size_t size = std::size_t{1} << random() % 4;
            for (std::size_t k = 0; k < size && at + k < bytes.size(); ++k)
                bytes[at + k] = static_cast<char>(value >> (8 * k));
            break;
        }
        default: {  // text in place of text
            const std::string& token = kTokens[below(kTokens.size())];
            bytes.replace(at, std::min(token.size(), bytes.size() - at), token);
            break;
        }
    }
}

}  // namespace mutate_detail

/// Damages a file's content: one to four random changes (bits, bytes, blocks, truncation, extreme
/// integers, odd text). The same seed gives the same result. Half of the seeds aim at the first 4
/// KiB, where formats keep their headers.
inline std::string mutate(std::string bytes, std::uint64_t seed) {
    constexpr std::size_t kHeaderBytes = 4096;
    std::mt19937_64 random(seed);
    for (std::uint64_t changes = 1 + random() % 4; changes > 0 && !bytes.empty(); --changes) {
        if (random() % 2 == 0 && bytes.size() > kHeaderBytes) {
            std::string header = bytes.substr(0, kHeaderBytes);
            mutate_detail::mutate_once(header, random);
            bytes.replace(0, kHeaderBytes, header);
        } else {
            mutate_detail::mutate_once(bytes, random);
        }
    }
    return bytes;
}

}  // namespace nearfield::test
