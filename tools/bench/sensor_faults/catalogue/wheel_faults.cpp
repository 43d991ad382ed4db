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

/// The wheels turn factor(t, wheel) times as far as they do.
template <class Factor>
auto turning(Factor factor) {
  return [factor, last = std::optional<wheels_t>(), angle = std::array<double, 2>{}](double t, wheels_t& m) mutable {
    const wheels_t measured = m;
    if (!last) {
      last = m;
      angle = {m.angle[0], m.angle[1]};
    }
    for (int wheel = 0; wheel < 2; ++wheel) {
      const auto k = static_cast<std::size_t>(wheel);
      const double per_rad =
          std::abs(measured.angle[wheel]) > 1e-6 ? double(measured.counts[wheel]) / measured.angle[wheel] : 0;
      const double by = factor(t, wheel);
      angle[k] += by * (measured.angle[wheel] - last->angle[wheel]);
      m.angle[wheel] = angle[k];
      m.counts[wheel] = std::llround(angle[k] * per_rad);
      m.speed[wheel] *= by;
    }
    last = measured;
  };
}

/// From the first message on, as scale(wheel) says.
template <class Scale>
auto of_another_size(Scale scale) {
  return turning([scale](double, int wheel) { return scale(wheel); });
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

std::vector<Fault> wheels_on_the_road() {
  constexpr double kFrom = kFromTheBeginning;
  return {
      wheels("gear ratio x 10", "the encoder is on the motor's side: ten times the way", kFrom,
             of_another_size([](int) { return 10.0; })),
      wheels("right counts double", "the right encoder counts both edges: twice the way", kFrom,
             of_another_size([](int wheel) { return wheel == 1 ? 2.0 : 1.0; })),
      wheels("ice on the left", "the left wheel turns 80 % more for 8 s in each 16 s", kOnTheWay,
             turning([](double t, int wheel) { return wheel == 0 && std::fmod(t, 16.0) < 8.0 ? 1.8 : 1.0; })),
      wheels("brake locks", "both wheels stand still for 1.5 s in each 10 s while the vehicle slides", kOnTheWay,
             turning([](double t, int) { return std::fmod(t, 10.0) < 1.5 ? 0.0 : 1.0; })),
      wheels("left wheel slides now and then", "it stands still for 1 s in each 5 s", kOnTheWay,
             turning([](double t, int wheel) { return wheel == 0 && std::fmod(t, 5.0) < 1.0 ? 0.0 : 1.0; })),
      wheels("counts begin again", "both counts are 0 again each 10 s: the drive's controller restarts", kOnTheWay,
             [first = std::optional<wheels_t>()](double t, auto& m) mutable {
               if (!first || std::fmod(t, 10.0) < 0.011) first = m;
               for (int wheel = 0; wheel < 2; ++wheel) {
                 m.counts[wheel] -= first->counts[wheel];
                 m.angle[wheel] -= first->angle[wheel];
               }
             }),
      wheels("counts of 16 bits", "the counts overflow and nobody unwraps them", kFrom,
             [](double, auto& m) {
               for (int wheel = 0; wheel < 2; ++wheel) {
                 const double per_rad = std::abs(m.angle[wheel]) > 1e-6 ? double(m.counts[wheel]) / m.angle[wheel] : 0;
                 m.counts[wheel] = static_cast<std::int16_t>(m.counts[wheel]);
                 if (per_rad != 0) m.angle[wheel] = double(m.counts[wheel]) / per_rad;
               }
             }),
      wheels("gateway stalls", "the same counts come for 1 s in each 4 s", kOnTheWay,
             [held = std::optional<wheels_t>()](double t, auto& m) mutable {
               if (std::fmod(t, 4.0) >= 1.0) {
                 held.reset();
                 return;
               }
               if (!held) held = m;
               for (int wheel = 0; wheel < 2; ++wheel) {
                 m.counts[wheel] = held->counts[wheel];
                 m.angle[wheel] = held->angle[wheel];
                 m.speed[wheel] = held->speed[wheel];
               }
             }),
      wheels("wheels in TAI", "stamps are 37 s ahead", kFrom, [](double, auto& m) { m.utime += 37'000'000; }),
  };
}

}  // namespace

std::vector<Fault> wheel_faults() {
  std::vector<Fault> faults = wheels_wrongly_set_up();
  for (Fault& fault : wheels_failing()) faults.push_back(std::move(fault));
  for (Fault& fault : wheels_on_the_road()) faults.push_back(std::move(fault));
  return faults;
}

}  // namespace curbstone::bench::sensor_faults::catalogue
