#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

constexpr std::array kLeft = {0};
constexpr std::array kBoth = {0, 1};

template <class Function>
Fault wheels(std::string name, std::string words, double from, Function function) {
  return {"wheels", std::move(name), std::move(words), from,
          [function] { return Changes{.wheels = change<wheels_t>(function)}; }};
}

void negate(wheels_t& m, int wheel) {
  m.counts[wheel] = -m.counts[wheel];
  m.angle[wheel] = -m.angle[wheel];
  m.speed[wheel] = -m.speed[wheel];
}

/// The wheels count `factor` times as far as they turn, from the first message on.
template <class Wheels>
auto scaled(double factor, Wheels which) {
  return [factor, which, first = std::optional<wheels_t>()](double, wheels_t& m) mutable {
    if (!first) first = m;
    for (const int wheel : which) {
      m.counts[wheel] = first->counts[wheel] + std::llround(factor * double(m.counts[wheel] - first->counts[wheel]));
      m.angle[wheel] = first->angle[wheel] + factor * (m.angle[wheel] - first->angle[wheel]);
      m.speed[wheel] *= factor;
    }
  };
}

/// The file has 1 / `factor` of the encoder's counts a revolution: the counts are right and the angles are not.
auto other_revolution(double factor) {
  return [factor](double, wheels_t& m) {
    for (const int wheel : kBoth) {
      m.angle[wheel] *= factor;
      m.speed[wheel] *= factor;
    }
  };
}

/// While slips(t), the wheels turn by `more` of their speed in addition.
template <class Wheels, class Slips>
auto slipping(double more, Wheels which, Slips slips) {
  return [more, which, slips, last = std::optional<wheels_t>(), slipped = std::array<double, 2>{}](
             double t, wheels_t& m) mutable {
    const wheels_t measured = m;
    if (!last) last = m;
    const double seconds = double(m.utime - last->utime) * 1e-6;
    for (const int wheel : which) {
      const double angle = measured.angle[wheel];
      const double counts = std::abs(angle) > 1e-6 ? double(measured.counts[wheel]) / angle : 0;  // per rad
      if (slips(t)) {
        slipped[std::size_t(wheel)] += more * measured.speed[wheel] * seconds;
        m.speed[wheel] *= 1 + more;
      }
      m.angle[wheel] += slipped[std::size_t(wheel)];
      m.counts[wheel] += std::llround(slipped[std::size_t(wheel)] * counts);
    }
    last = measured;
  };
}

template <class Wheels>
auto frozen(Wheels which) {
  return [which, first = std::optional<wheels_t>()](double, wheels_t& m) mutable {
    if (!first) first = m;
    for (const int wheel : which) {
      m.counts[wheel] = first->counts[wheel];
      m.angle[wheel] = first->angle[wheel];
      m.speed[wheel] = 0;
    }
  };
}

/// Whether t is in the first `part` s of each `period` s.
auto each(double period, double part) {
  return [=](double t) { return std::fmod(t, period) < part; };
}

std::vector<Fault> wheels_wrongly_set_up() {
  constexpr double kFrom = kFromTheBeginning;
  return {
      wheels("left backwards", "the left wheel counts backwards", kFrom, [](double, auto& m) { negate(m, 0); }),
      wheels("both backwards", "both wheels count backwards", kFrom,
             [](double, auto& m) {
               negate(m, 0);
               negate(m, 1);
             }),
      wheels("wheels swapped", "left is right and right is left", kFrom,
             [](double, auto& m) {
               std::swap(m.counts[0], m.counts[1]);
               std::swap(m.angle[0], m.angle[1]);
               std::swap(m.speed[0], m.speed[1]);
             }),
      wheels("counts / revolution x 1/2", "the file has half the counts per revolution: twice the way", kFrom,
             other_revolution(2.0)),
      wheels("counts / revolution x 2", "the file has twice the counts per revolution: half the way", kFrom,
             other_revolution(0.5)),
      wheels("wheel stamps late", "stamps 120 ms after the counts were sampled", kFrom,
             [](double, auto& m) { m.utime += 120'000; }),
      wheels("wheels at 1/20 rate", "one message in twenty", kFrom,
             [n = 0](double, auto&) mutable { return ++n % 20 == 0; }),
  };
}

std::vector<Fault> wheels_failing() {
  return {
      wheels("wheels silent", "no more messages", kOnTheWay, [](double, auto&) { return false; }),
      wheels("left frozen", "the left wheel's counts stand still", kOnTheWay, frozen(kLeft)),
      wheels("both frozen", "the counts of both wheels stand still", kOnTheWay, frozen(kBoth)),
      wheels("flat tyre", "the left wheel's radius is 5 % less: it turns faster", kOnTheWay, scaled(1 / 0.95, kLeft)),
      wheels("left slips", "the left wheel turns 60 % more for 1/2 s every 2 s", kOnTheWay,
             slipping(0.6, kLeft, each(2.0, 0.5))),
      wheels("left slips rarely", "the left wheel turns 60 % more for 1/2 s every 10 s", kOnTheWay,
             slipping(0.6, kLeft, each(10.0, 0.5))),
      wheels("both slip", "both wheels turn 30 % more for 2 s every 6 s, as on snow", kOnTheWay,
             slipping(0.3, kBoth, each(6.0, 2.0))),
      wheels("counts jump", "the left angle jumps by 0.7 rad, in 1 of 200 messages, and stays there", kOnTheWay,
             [random = Random(1), jumped = 0.0](double, auto& m) mutable {
               if (random.chance(0.005)) jumped += 0.7;
               m.angle[0] += jumped;
             }),
      wheels("wheel spikes", "the left angle is 50 rad off in 1 of 200 messages", kOnTheWay,
             [random = Random(1)](double, auto& m) mutable {
               if (random.chance(0.005)) m.angle[0] += random.chance(0.5) ? 50.0 : -50.0;
             }),
      wheels("wheel noise", "0.05 rad of noise on either angle", kOnTheWay,
             [random = Random(1)](double, auto& m) mutable {
               for (double& angle : m.angle) angle += random.normal(0.05);
             }),
      wheels("wheel clock set back", "stamps jump back by 2 s, and go on from there", kOnTheWay,
             [](double, auto& m) { m.utime -= 2'000'000; }),
  };
}

}  // namespace

std::vector<Fault> wheel_faults() {
  std::vector<Fault> faults = wheels_wrongly_set_up();
  for (Fault& fault : wheels_failing()) faults.push_back(std::move(fault));
  return faults;
}

}  // namespace curbstone::bench::sensor_faults::catalogue
