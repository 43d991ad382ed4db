#include "common/bus/socket/fragment_assembler.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "common/bytes/big_endian.hpp"

namespace curbstone {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kSender = 0x7F000001ABCD;
constexpr std::size_t kPiece = 1000;  // bytes in a fragment; LCM's have 65,487

Bytes content(std::size_t size, unsigned seed = 1) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

/// A fragment as LCM 1.3.1 writes it.
Bytes fragment(std::uint32_t sequence, std::uint32_t size, std::uint32_t offset, std::uint16_t number,
               std::uint16_t count, const std::string& channel, std::span<const std::uint8_t> piece) {
  Bytes datagram;
  append_big_endian(datagram, FragmentAssembler::kMagic);
  append_big_endian(datagram, sequence);
  append_big_endian(datagram, size);
  append_big_endian(datagram, offset);
  append_big_endian(datagram, number);
  append_big_endian(datagram, count);
  if (number == 0) datagram.insert(datagram.end(), channel.c_str(), channel.c_str() + channel.size() + 1);
  datagram.insert(datagram.end(), piece.begin(), piece.end());
  return datagram;
}

/// The first piece is shorter by the channel's name.
std::vector<Bytes> cut(std::uint32_t sequence, const std::string& channel, const Bytes& bytes) {
  std::vector<std::span<const std::uint8_t>> pieces;
  std::span<const std::uint8_t> rest(bytes);
  for (std::size_t size = kPiece - channel.size() - 1; !rest.empty(); size = kPiece) {
    pieces.push_back(rest.first(std::min(size, rest.size())));
    rest = rest.subspan(pieces.back().size());
  }
  std::vector<Bytes> datagrams;
  std::uint32_t offset = 0;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    datagrams.push_back(fragment(sequence, static_cast<std::uint32_t>(bytes.size()), offset,
                                 static_cast<std::uint16_t>(k), static_cast<std::uint16_t>(pieces.size()), channel,
                                 pieces[k]));
    offset += static_cast<std::uint32_t>(pieces[k].size());
  }
  return datagrams;
}

class LargeMessages : public ::testing::Test {
 protected:
  std::optional<FragmentAssembler::Whole> add(const std::vector<Bytes>& datagrams, std::uint64_t sender = kSender) {
    std::optional<FragmentAssembler::Whole> last;
    for (const Bytes& datagram : datagrams)
      if (auto whole = assembler_.add(sender, datagram, now_)) last = std::move(whole);
    return last;
  }
  std::int64_t now_ = 1'000'000;
  FragmentAssembler assembler_{{"CLOUD", "IMAGE"}, {.message = 100'000, .total = 150'000, .senders = 3}};
};

TEST_F(LargeMessages, ArePutTogetherToTheByte) {
  for (const std::size_t size : {kPiece, kPiece + 1, std::size_t{70'000}, std::size_t{100'000}}) {
    const Bytes bytes = content(size);
    const auto whole = add(cut(7, "CLOUD", bytes));
    ASSERT_TRUE(whole) << size;
    EXPECT_EQ(whole->channel, "CLOUD");
    EXPECT_EQ(whole->bytes, bytes);
    EXPECT_EQ(assembler_.held(), 0U);
  }
  EXPECT_EQ(assembler_.refused() + assembler_.dropped(), 0);
}

TEST_F(LargeMessages, OfChannelsThatNobodyAskedForCostNothing) {
  EXPECT_FALSE(add(cut(7, "CLOUDS", content(5000))));
  EXPECT_EQ(assembler_.held(), 0U);
  EXPECT_EQ(assembler_.refused() + assembler_.dropped(), 0);
}

TEST_F(LargeMessages, OfSeveralSendersMayComeMixed) {
  const auto a = cut(7, "CLOUD", content(5000, 1)), b = cut(7, "IMAGE", content(5000, 2));
  std::vector<FragmentAssembler::Whole> all;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (auto whole = assembler_.add(1, a[k], now_)) all.push_back(std::move(*whole));
    if (auto whole = assembler_.add(2, b[k], now_)) all.push_back(std::move(*whole));
  }
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].bytes, content(5000, 1));
  EXPECT_EQ(all[1].bytes, content(5000, 2));
}

TEST_F(LargeMessages, OfWhichAFragmentIsMissingAreDroppedAndTheNextOneIsWhole) {
  auto holed = cut(7, "CLOUD", content(5000));
  holed.erase(holed.begin() + 2);
  EXPECT_FALSE(add(holed));
  EXPECT_EQ(assembler_.dropped(), 1);
  auto headless = cut(8, "CLOUD", content(5000));
  headless.erase(headless.begin());
  EXPECT_FALSE(add(headless));
  auto tailless = cut(9, "CLOUD", content(5000));
  tailless.pop_back();
  EXPECT_FALSE(add(tailless));
  EXPECT_TRUE(add(cut(10, "CLOUD", content(5000))));
  EXPECT_EQ(assembler_.dropped(), 2) << "the one without its end, when the next one began";
  EXPECT_EQ(assembler_.held(), 0U);
}

TEST_F(LargeMessages, AFragmentThatComesTwiceChangesNothing) {
  auto datagrams = cut(7, "CLOUD", content(5000));
  datagrams.insert(datagrams.begin() + 3, datagrams[2]);
  EXPECT_TRUE(add(datagrams));
}

TEST_F(LargeMessages, ThatStayIncompleteGoWhenTheyAreOldOrTheOthersNeedTheRoom) {
  const auto begin_only = [&](std::uint64_t sender, std::size_t size) {
    EXPECT_FALSE(add({cut(7, "CLOUD", content(size)).front()}, sender));
  };
  begin_only(1, 90'000);
  EXPECT_EQ(assembler_.held(), 90'000U);
  begin_only(2, 90'000);
  EXPECT_EQ(assembler_.held(), 90'000U) << "150,000 in all";
  EXPECT_EQ(assembler_.dropped(), 1);
  for (std::uint64_t sender = 3; sender < 10; ++sender) begin_only(sender, 2000);
  EXPECT_LE(assembler_.held(), 90'000U + 2 * 2000U) << "of three senders";
  now_ += FragmentAssembler::kPatience + 1;
  begin_only(20, 2000);
  EXPECT_EQ(assembler_.held(), 2000U);
}

TEST_F(LargeMessages, WhatNoSenderSendsIsRefusedAndHoldsNothing) {
  const Bytes piece = content(100);
  const std::vector<Bytes> bad = {
      {},
      Bytes(19, 'L'),
      fragment(1, 5000, 0, 0, 0, "CLOUD", piece),               // none of none
      fragment(1, 5000, 0, 5, 5, "CLOUD", piece),               // the sixth of five
      fragment(1, 50, 0, 0, 2, "CLOUD", piece),                 // more than the whole
      fragment(1, 5000, 4950, 1, 5, "CLOUD", piece),            // beyond the end
      fragment(1, 5000, 0xFFFFFFF0, 1, 5, "CLOUD", piece),      // which ended LCM's own receiver
      fragment(1, 5000, 10, 0, 5, "CLOUD", piece),              // the first one is not at the beginning
      fragment(1, 1U << 28, 0, 0, 2, "CLOUD", piece),           // 268 MB
      fragment(1, 5000, 0, 0, 2, std::string(64, 'x'), piece),  // a name that is too long
      fragment(1, 5000, 0, 0, 2, "", piece),
  };
  for (const Bytes& datagram : bad) EXPECT_FALSE(assembler_.add(kSender, datagram, now_));
  Bytes unterminated = fragment(1, 5000, 0, 0, 2, "CLOUD", {});
  unterminated.pop_back();
  EXPECT_FALSE(assembler_.add(kSender, unterminated, now_));
  EXPECT_EQ(assembler_.refused(), static_cast<std::int64_t>(bad.size()) + 1);
  EXPECT_EQ(assembler_.held(), 0U);
}

TEST_F(LargeMessages, AnyBytesAreSurvivedWithinTheBounds) {
  std::mt19937 random(5);
  for (int i = 0; i < 20'000; ++i) {
    auto datagrams = cut(static_cast<std::uint32_t>(random() % 3), random() % 2 == 0 ? "CLOUD" : "IMAGE",
                         content(1 + random() % 3000, static_cast<unsigned>(i)));
    Bytes& one = datagrams[random() % datagrams.size()];
    for (unsigned flips = random() % 4; flips > 0; --flips)
      one[random() % std::min<std::size_t>(one.size(), 30)] ^= static_cast<std::uint8_t>(1U << random() % 8);
    if (random() % 4 == 0) one.resize(random() % one.size());
    now_ += static_cast<std::int64_t>(random() % 100'000);
    if (const auto whole = assembler_.add(random() % 5, one, now_)) {
      EXPECT_LE(whole->bytes.size(), 100'000U);
    }
    ASSERT_LE(assembler_.held(), 150'000U);
  }
}

}  // namespace
}  // namespace curbstone
