// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace scanlock {

/// Points per chunk, for work that takes about as long per point as a search for its neighbours.
inline constexpr std::size_t kChunk = 256;

/// Calls work(begin, end) for consecutive chunks of [0, n), on up to `threads` threads.
/// The chunks do not depend on `threads`, and `work` may only write to elements of its own chunk, so that the
/// result does not depend on `threads` either. `work` must not throw.
template <typename Work>
void for_each_chunk(std::size_t n, std::size_t chunk_size, int threads, const Work& work) {
  const std::size_t chunks = (n + chunk_size - 1) / chunk_size;
  const std::size_t workers = std::min(chunks, static_cast<std::size_t>(std::max(threads, 1)));
  const auto run = [&](std::size_t worker) {
    for (std::size_t chunk = worker; chunk < chunks; chunk += workers) {
      work(chunk * chunk_size, std::min(n, (chunk + 1) * chunk_size));
    }
  };
  if (workers <= 1) {
    if (chunks > 0) run(0);
    return;
  }
  std::vector<std::thread> team;
  team.reserve(workers - 1);
  for (std::size_t worker = 1; worker < workers; ++worker) team.emplace_back(run, worker);
  run(0);
  for (std::thread& thread : team) thread.join();
}

}  // namespace scanlock
