// The baseline: about a hundred lines of what one would write without a bit field. Balls in single precision
// (double for the reference of the table of speed), sorted by the square cell of their centre every step
// (a counting sort, so that a cell's balls lie side by side), then every ball against those behind it in its
// own cell, the cell to the right and the three below. An impulse along the line of the centres where they
// approach, and what overlap there is, is taken out by pushing them apart.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine.h"

namespace thimble::benchmarks {
namespace {

template <class Real>
struct GridBall {
  Real x, y, vx, vy, radius, mass;
};

template <class Real>
class GridEngine : public Engine {
 public:
  GridEngine(const Scene& scene, int substeps)
      : width_(static_cast<Real>(scene.width)),
        height_(static_cast<Real>(scene.height)),
        restitution_(static_cast<Real>(scene.restitution)),
        gravity_(static_cast<Real>(scene.gravity)),
        across_(static_cast<std::size_t>(scene.width) / kCell + 3),
        substeps_(substeps),
        walls_(scene.wall_columns) {
    const std::size_t down = static_cast<std::size_t>(scene.height) / kCell + 3;
    for (const BallState& ball : scene.balls) {
      const Real d = static_cast<Real>(ball.diameter);
      balls_.push_back({static_cast<Real>(ball.x), static_cast<Real>(ball.y), static_cast<Real>(ball.vx),
                        static_cast<Real>(ball.vy), d / 2, d * d});
      ids_.push_back(static_cast<std::uint32_t>(ids_.size()));
    }
    sorted_ = balls_;
    sorted_ids_ = ids_;
    cells_.resize(balls_.size());
    first_.resize(across_ * down + 1);
  }

  void step() override {
    for (int i = 0; i < substeps_; ++i) {
      advance(Real{1} / static_cast<Real>(substeps_));
    }
  }

  std::uint64_t collisions() const override { return collisions_; }
  std::vector<BallState> balls() const override {
    std::vector<BallState> result(balls_.size());
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      const Ball& b = balls_[i];
      result[ids_[i]] = {b.x, b.y, b.vx, b.vy, 2 * static_cast<double>(b.radius), false};
    }
    return result;
  }
  std::size_t asleep() const override { return 0; }
  std::size_t memory_bytes() const override {
    return 2 * balls_.size() * (sizeof(Ball) + sizeof(std::uint32_t)) +
           (cells_.size() + first_.size()) * sizeof(std::uint32_t);
  }

 private:
  using Ball = GridBall<Real>;

  static constexpr std::size_t kCell =
      16;  // pixels; at least the greatest diameter, and the fastest of those tried

  void advance(Real dt) {
    std::fill(first_.begin(), first_.end(), 0U);
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      Ball& b = balls_[i];
      const Real before = b.x;
      b.vy += gravity_ * dt;
      b.x += b.vx * dt;
      b.y += b.vy * dt;
      bounce(b.x, b.vx, b.radius, width_ - b.radius);
      bounce(b.y, b.vy, b.radius, height_ - b.radius);
      for (const int wall : walls_) {
        one_pixel_wall(b, before, static_cast<Real>(wall));
      }
      cells_[i] = static_cast<std::uint32_t>((static_cast<std::size_t>(b.y) / kCell + 1) * across_ +
                                             static_cast<std::size_t>(b.x) / kCell + 1);
      ++first_[cells_[i]];
    }
    std::uint32_t end = 0;
    for (std::uint32_t& first : first_) {
      end += first;
      first = end;  // counted down to the first below
    }
    for (std::size_t i = balls_.size(); i-- > 0;) {
      const std::uint32_t to = --first_[cells_[i]];
      sorted_[to] = balls_[i];
      sorted_ids_[to] = ids_[i];
    }
    balls_.swap(sorted_);
    ids_.swap(sorted_ids_);
    for (std::size_t cell = across_; cell + across_ < first_.size() - 2; ++cell) {
      for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        collide_with(i, i + 1, first_[cell + 2]);
        collide_with(i, first_[cell + across_ - 1], first_[cell + across_ + 2]);
      }
    }
  }
  void collide_with(std::uint32_t i, std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t j = from; j < to; ++j) {
      const Real dx = balls_[j].x - balls_[i].x;
      const Real dy = balls_[j].y - balls_[i].y;
      const Real reach = balls_[i].radius + balls_[j].radius;
      const Real square = dx * dx + dy * dy;
      if (square < reach * reach && square > 0) {
        collide(balls_[i], balls_[j], dx, dy, square, reach);
      }
    }
  }
  void collide(Ball& a, Ball& b, Real dx, Real dy, Real square, Real reach) {
    const Real share_a = b.mass / (a.mass + b.mass);
    const Real share_b = 1 - share_a;
    const Real approach = (b.vx - a.vx) * dx + (b.vy - a.vy) * dy;
    if (approach < 0) {
      ++collisions_;
      const Real impulse = (1 + restitution_) * approach / square;
      a.vx += impulse * share_a * dx;
      a.vy += impulse * share_a * dy;
      b.vx -= impulse * share_b * dx;
      b.vy -= impulse * share_b * dy;
    }
    const Real apart = reach / std::sqrt(square) - 1;
    a.x -= apart * share_a * dx;
    a.y -= apart * share_a * dy;
    b.x += apart * share_b * dx;
    b.y += apart * share_b * dy;
  }
  void bounce(Real& place, Real& speed, Real low, Real high) {
    if (place < low || place > high) {
      const bool below = place < low;
      place = below ? low : high;
      if (below == (speed < 0)) {
        ++collisions_;
        speed = -restitution_ * speed;
      }
    }
  }
  // A wall is a place that a ball may not overlap; like most, it looks at where the ball is, not at its way.
  void one_pixel_wall(Ball& b, Real before, Real wall) {
    if (b.x > wall - b.radius && b.x < wall + 1 + b.radius) {
      b.x = before < wall ? wall - b.radius : wall + 1 + b.radius;
      b.vx = -restitution_ * b.vx;
      ++collisions_;
    }
  }

  Real width_;
  Real height_;
  Real restitution_;
  Real gravity_;
  std::size_t across_;
  int substeps_;
  std::vector<int> walls_;
  std::vector<Ball> balls_;
  std::vector<Ball> sorted_;
  std::vector<std::uint32_t> ids_;
  std::vector<std::uint32_t> sorted_ids_;
  std::vector<std::uint32_t> cells_;
  std::vector<std::uint32_t> first_;
  std::uint64_t collisions_ = 0;
};

}  // namespace

std::unique_ptr<Engine> make_grid_engine(const Scene& scene) {
  return std::make_unique<GridEngine<float>>(scene, 1);
}

std::unique_ptr<Engine> make_reference_engine(const Scene& scene, int substeps) {
  return std::make_unique<GridEngine<double>>(scene, substeps);
}

}  // namespace thimble::benchmarks
