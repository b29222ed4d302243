#include "node/worker_pool.hpp"

#include <atomic>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

namespace scree::node {
namespace {

/// Every index must be visited exactly once, whatever the pool.
void expect_each_index_once(WorkerPool& pool, int count) {
  std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
  pool.for_ranges(count, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
  });
  for (const auto& visited : visits) ASSERT_EQ(visited.load(), 1);
}

TEST(WorkerPool, VisitsEachIndexOnceWithThreads) {
  WorkerPool pool(3);
  std::vector<std::jthread> threads;
  for (int i = 0; i < 2; ++i) threads.emplace_back([&](const std::stop_token& stop) { pool.work(stop); });
  for (int loop = 0; loop < 500; ++loop) expect_each_index_once(pool, 1 + loop % 17);
}

TEST(WorkerPool, WorksWithoutItsThreads) {
  WorkerPool pool(4);
  for (const int count : {0, 1, 3, 4, 1000}) expect_each_index_once(pool, count);
}

}  // namespace
}  // namespace scree::node
