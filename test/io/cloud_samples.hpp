// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <type_traits>

#include "temporary_directory.hpp"

namespace scanlock {

/// Builds binary files by hand.
class ByteBuilder {
 public:
  explicit ByteBuilder(bool big_endian = false) : big_endian_(big_endian) {}

  ByteBuilder& text(const std::string& text) {
    bytes.insert(bytes.end(), text.begin(), text.end());
    return *this;
  }
  template <typename T>
  ByteBuilder& put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    Bytes raw(sizeof value);
    std::memcpy(raw.data(), &value, sizeof value);
    if (big_endian_) std::reverse(raw.begin(), raw.end());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
    return *this;
  }

  Bytes bytes;

 private:
  bool big_endian_;
};

/// Faces and a camera before the vertices, a list within them, every scalar type: (1 2 3), (-4 5.5 6e2).
inline Bytes odd_binary_ply(bool big_endian) {
  ByteBuilder b(big_endian);
  b.text("ply\r\nformat binary_")
      .text(big_endian ? "big" : "little")
      .text("_endian 1.0\r\ncomment by hand\r\n");
  b.text("element face 2\r\nproperty list uchar int vertex_indices\r\nproperty uchar flags\r\n");
  b.text("element camera 1\r\nproperty double focus\r\nproperty short id\r\n");
  b.text(
      "element vertex 2\r\nproperty float64 z\r\nproperty list uint8 float32 extra\r\nproperty int8 x\r\n");
  b.text("property ushort Intensity\r\nproperty float y\r\nproperty float nz\r\nproperty float nx\r\n");
  b.text("property float ny\r\nproperty uint t\r\nend_header\r\n");
  b.put<std::uint8_t>(3).put<int>(0).put<int>(1).put<int>(1).put<std::uint8_t>(9);
  b.put<std::uint8_t>(0).put<std::uint8_t>(9);
  b.put<double>(50).put<std::int16_t>(-7);
  b.put<double>(3).put<std::uint8_t>(2).put<float>(8).put<float>(9).put<std::int8_t>(1).put<std::uint16_t>(
      65535);
  b.put<float>(2).put<float>(1).put<float>(0).put<float>(0).put<std::uint32_t>(77);
  b.put<double>(6e2).put<std::uint8_t>(0).put<std::int8_t>(-4).put<std::uint16_t>(7);
  b.put<float>(5.5).put<float>(0).put<float>(0.6f).put<float>(0.8f).put<std::uint32_t>(77);
  return b.bytes;
}

inline std::string ascii_ply() {
  return "ply\nformat ascii 1.0\nobj_info x\nelement vertex 2\nproperty float y\nproperty float x\nproperty "
         "double z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n2 1 3\n\n5.5 -4 6e2\n3 0 1 1\n";
}

inline const char* const kPcdHeader =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS intensity _ y x z stamp\nSIZE 2 1 4 8 4 8\nTYPE U U F F I U\n"
    "COUNT 1 3 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";

inline Bytes binary_pcd() {
  ByteBuilder b;
  b.text(kPcdHeader).text("binary\n");
  b.put<std::uint16_t>(65535)
      .text("abc")
      .put<float>(2)
      .put<double>(1)
      .put<std::int32_t>(3)
      .put<std::uint64_t>(1);
  b.put<std::uint16_t>(7)
      .text("abc")
      .put<float>(5.5)
      .put<double>(-4)
      .put<std::int32_t>(600)
      .put<std::uint64_t>(1);
  return b.bytes;
}

inline std::string ascii_pcd() {
  return std::string(kPcdHeader) + "ascii\n65535 0 0 0 2 1 3 99\n7 0 0 0 5.5 -4 600 99\n";
}

/// Field after field; the padding is one literal byte and a copy that overlaps itself, the other bytes are
/// literal.
inline Bytes compressed_pcd() {
  ByteBuilder data;
  data.put<std::uint8_t>(4).put<std::uint16_t>(65535).put<std::uint16_t>(7).text("a");  // a run of five
  data.put<std::uint8_t>(3 << 5).put<std::uint8_t>(0);                                  // five more of 'a'
  data.put<std::uint8_t>(31).put<float>(2).put<float>(5.5).put<double>(1).put<double>(-4);  // a run of 32
  data.put<std::int32_t>(3).put<std::int32_t>(600);
  data.put<std::uint8_t>(0).put<std::uint8_t>(1).put<std::uint8_t>(0).put<std::uint8_t>(0);  // 1 0
  data.put<std::uint8_t>(4 << 5).put<std::uint8_t>(0);                                       // six zeros more
  data.put<std::uint8_t>(6 << 5).put<std::uint8_t>(7);  // the same eight again
  ByteBuilder b;
  b.text(kPcdHeader).text("binary_compressed\n");
  b.put<std::uint32_t>(static_cast<std::uint32_t>(data.bytes.size())).put<std::uint32_t>(2 * 29);
  b.bytes.insert(b.bytes.end(), data.bytes.begin(), data.bytes.end());
  return b.bytes;
}

}  // namespace scanlock
