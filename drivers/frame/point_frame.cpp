#include "drivers/frame/point_frame.hpp"

namespace scree {

PixelCounts& PixelCounts::operator+=(const PixelCounts& other) {
  pixels += other.pixels;
  points += other.points;
  no_return += other.no_return;
  untrusted_row += other.untrusted_row;
  out_of_limits += other.out_of_limits;
  self += other.self;
  speckle += other.speckle;
  mixed += other.mixed;
  ambiguous += other.ambiguous;
  assumed_first_interval += other.assumed_first_interval;
  wrapped += other.wrapped;
  return *this;
}

}  // namespace scree
