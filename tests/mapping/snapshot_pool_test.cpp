#include "mapping/snapshot_pool.hpp"

#include <gtest/gtest.h>
#include <optional>
#include <thread>

namespace scree::mapping {
namespace {

TEST(SnapshotPool, ReusesTheBuffersOfReleasedSnapshots) {
  SnapshotPool pool;
  const float* buffer = nullptr;
  {
    auto first = pool.acquire();
    first->elevation_m.assign(50, 50, 1.0F);
    buffer = first->elevation_m.data();
  }
  for (int i = 0; i < 100; ++i) {
    auto next = pool.acquire();
    next->elevation_m.assign(50, 50, 2.0F);
    EXPECT_EQ(next->elevation_m.data(), buffer);
  }
  EXPECT_EQ(pool.size(), 1U);
}

TEST(SnapshotPool, NeverHandsOutASnapshotThatIsHeld) {
  SnapshotPool pool;
  const auto held = pool.acquire();
  EXPECT_NE(pool.acquire().get(), held.get());
  EXPECT_EQ(pool.size(), 2U);
}

TEST(SnapshotPool, AWeakReferenceKeepsTheSlot) {
  SnapshotPool pool;
  auto held = pool.acquire();
  const MapSnapshot* place = held.get();
  std::weak_ptr<MapSnapshot> weak = held;
  held.reset();
  EXPECT_NE(pool.acquire().get(), place);
  weak.reset();
  const auto a = pool.acquire();
  const auto b = pool.acquire();
  EXPECT_TRUE(a.get() == place || b.get() == place);
}

TEST(SnapshotPool, SnapshotsOutliveThePool) {
  std::optional<SnapshotPool> pool(std::in_place);
  auto snapshot = pool->acquire();
  snapshot->revision = 7;
  pool.reset();
  EXPECT_EQ(snapshot->revision, 7U);
}

TEST(SnapshotPool, ReadersOnOtherThreadsGiveBuffersBack) {
  SnapshotPool pool;
  for (int round = 0; round < 200; ++round) {
    auto snapshot = pool.acquire();
    snapshot->revision = static_cast<std::uint32_t>(round);
    std::shared_ptr<const MapSnapshot> shared = std::move(snapshot);
    const std::jthread reader([shared, round] { EXPECT_EQ(shared->revision, static_cast<std::uint32_t>(round)); });
  }
  EXPECT_LE(pool.size(), 2U);
}

}  // namespace
}  // namespace scree::mapping
