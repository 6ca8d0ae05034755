// Columns of lit particles: codes, packing, and what a viewer must not take.
#include <random>

#include <gtest/gtest.h>

#include "protocol/lit_particles.h"

namespace brume::lit {
namespace {

// Rows with every column, whose numbers depend on the particle's id and on `time`.
Rows rowsAt(uint64_t first, uint32_t count, uint32_t time) {
    Rows rows{first, count, {}};
    for (uint32_t column = 0; column < kColumns; ++column) {
        rows.columns[column].resize(count);
        for (uint32_t i = 0; i < count; ++i) {
            std::minstd_rand random(uint32_t((first + i) * 977 + column * uint64_t(31) + 1));
            const uint32_t mask = (1u << bitsOf(column)) - 1;
            rows.columns[column][i] = uint16_t((random() + time * uint64_t(column % 5)) & mask);
        }
    }
    return rows;
}

bool same(const Rows& a, const Rows& b) {
    if (a.first != b.first || a.count != b.count) return false;
    for (uint32_t column = 0; column < kColumns; ++column)
        for (uint32_t i = 0; i < a.count; ++i) {
            const auto of = [&](const Rows& rows) {
                return rows.columns[column].empty() ? 0 : rows.columns[column][i];
            };
            if (of(a) != of(b)) return false;
        }
    return true;
}

std::optional<Rows> unpacked(const Rows& rows, const PackedRows& packed, const Rows* reference) {
    return unpack(rows.first, rows.count, packed.present, packed.bytes, reference);
}

TEST(LitParticles, CodesKeepWhatTheySay) {
    for (float x = 1e-9f; x < 1e9f; x *= 1.37f) EXPECT_NEAR(ofLogCode(logCode(x)) / x, 1, 3.5e-4) << x;
    EXPECT_EQ(ofLogCode(logCode(0)), 0);
    EXPECT_EQ(ofLogCode(logCode(-1)), 0);
    EXPECT_EQ(ofLogCode(logCode(NAN)), 0);
    for (float x = 0; x <= 1; x += 0.003f) {
        EXPECT_NEAR(ofRootCode(rootCode(x)), x, 0.5f / 255 * (2 * std::sqrt(x) + 0.01f)) << x;
        for (const float y : {x, -x})
            EXPECT_NEAR(ofSignedCode(signedCode(y)), y, 0.5f / 127 * (2 * std::sqrt(x) + 0.01f));
    }
    EXPECT_EQ(ofRootCode(rootCode(7)), 1);
    EXPECT_EQ(ofSignedCode(signedCode(-7)), -1);
}

// Who takes every message, every second, fourth or eighth one finds each reference among those.
TEST(LitParticles, EveryPaceHasItsReferences) {
    for (const uint32_t every : {1u, 2u, 4u, 8u})
        for (uint32_t number = every; number < 200; number += every) {
            const uint32_t reference = referenceOf(number);
            EXPECT_LT(reference, number);
            EXPECT_EQ(reference % every, 0u);
            if (reference == 0) continue;
            EXPECT_GE(layerOf(reference), std::min(layerOf(number) + 1, kLayers - 1)) << "no upper layer refers to it";
            for (uint32_t between = reference + every; between < number; between += every)
                EXPECT_NE(layerOf(between), layerOf(reference)) << "it is the newest of its layer";
        }
}

TEST(LitParticles, WholeRowsComeBack) {
    Packer packer;
    for (const uint32_t count : {0u, 1u, 7u, 1500u}) {
        const Rows rows = rowsAt(3, count, 5);
        const auto back = unpacked(rows, packer.pack(rows, nullptr), nullptr);
        ASSERT_TRUE(back) << count;
        EXPECT_TRUE(same(*back, rows)) << count;
    }
}

// Particles that are gone, that stay and that are new; also where none stays, and where the reference begins later.
TEST(LitParticles, ChangesComeBackWhoeverIsBornOrDies) {
    Packer packer;
    const Rows before = rowsAt(100, 300, 1);
    for (const uint64_t first : {0ull, 50ull, 99ull, 100ull, 101ull, 250ull, 399ull, 400ull, 5000ull}) {
        const Rows now = rowsAt(first, 280, 2);
        const PackedRows packed = packer.pack(now, &before);
        const auto back = unpacked(now, packed, &before);
        ASSERT_TRUE(back) << first;
        EXPECT_TRUE(same(*back, now)) << first;
    }
}

TEST(LitParticles, WhatDoesNotChangeTakesNoBytes) {
    Packer packer;
    const Rows rows = rowsAt(0, 500, 1);
    const PackedRows packed = packer.pack(rows, &rows);
    EXPECT_EQ(packed.present, 0u);
    EXPECT_LT(packed.bytes.size(), 20u);
    const auto back = unpacked(rows, packed, &rows);
    ASSERT_TRUE(back);
    EXPECT_TRUE(same(*back, rows));
}

TEST(LitParticles, SmallChangesTakeFewBytes) {
    Packer packer;
    const Rows before = rowsAt(0, 2000, 0);
    Rows now = before;
    std::minstd_rand random(1);
    for (uint32_t axis = 0; axis < 3; ++axis)
        for (uint16_t& place : now.columns[kPlace + axis]) place = uint16_t(place + random() % 7 - 3);
    const size_t bytes = packer.pack(now, &before).bytes.size();
    EXPECT_LT(double(bytes) / 2000, 3 * 3.2 / 8) << "seven values are 2.8 bits";
}

TEST(LitParticles, BrokenColumnsAreRefused) {
    Packer packer;
    const Rows rows = rowsAt(0, 40, 1);
    const PackedRows good = packer.pack(rows, nullptr);
    EXPECT_FALSE(unpack(0, kMostParticles + 1, good.present, good.bytes, nullptr)) << "too many";
    EXPECT_FALSE(unpack(0, 41, good.present, good.bytes, nullptr)) << "fewer bytes than columns";
    EXPECT_FALSE(unpack(0, 39, good.present, good.bytes, nullptr)) << "more bytes than columns";
    EXPECT_FALSE(unpack(0, 40, good.present & ~1ull, good.bytes, nullptr)) << "a column less";
    EXPECT_FALSE(unpack(0, 40, good.present | 1ull << kColumns, good.bytes, nullptr)) << "a column that nobody knows";
    EXPECT_FALSE(unpack(0, 40, good.present, {}, nullptr)) << "nothing";
    std::vector<uint8_t> bytes = good.bytes;
    bytes.push_back(0);
    EXPECT_FALSE(unpack(0, 40, good.present, bytes, nullptr)) << "something after";
    for (size_t cut = 0; cut < good.bytes.size(); cut += 7)
        EXPECT_FALSE(unpack(0, 40, good.present, std::span(good.bytes).first(cut), nullptr)) << cut;
    for (size_t at = 0; at < good.bytes.size(); ++at) {
        bytes = good.bytes;
        bytes[at] ^= 0x10;
        const auto taken = unpack(0, 40, good.present, bytes, nullptr);
        EXPECT_TRUE(!taken || same(*taken, rows)) << "a checksum is kept: at most bits change that say nothing";
    }
}

} // namespace
} // namespace brume::lit
