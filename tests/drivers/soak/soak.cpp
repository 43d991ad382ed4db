// soak [--hours N]: an hour of sensor time on a bad line for each driver, as fast as this machine takes it; prints what
// came of it. Status 1 if a good packet was not used, or a stamp is off by more than 1 ms, or memory grew.
#include "tests/drivers/soak/soak.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

int main(int argc, char** argv) {
  using namespace curbstone::test;
  const double hours = argc == 3 && std::string(argv[1]) == "--hours" ? std::atof(argv[2]) : argc == 1 ? 1.0 : 0.0;
  if (hours <= 0.01) {
    std::fputs("usage: soak [--hours N]\n", stderr);
    return 2;
  }
  bool sound = true;
  for (const auto& run : {soak_xsens, soak_witmotion, soak_can, soak_modbus, soak_rs16, soak_vlp16, soak_helios32}) {
    const Ledger ledger = run(hours).ledger;
    sound = sound && ledger.used(Fate::kGood) == ledger.sent(Fate::kGood) &&
            ledger.used(Fate::kDoubled) == ledger.sent(Fate::kDoubled) && ledger.strange() == 0 &&
            std::abs(ledger.worst_error()) <= 1000 && ledger.growth() < 4 << 20;
  }
  std::puts(sound ? "sound" : "NOT sound");
  return sound ? 0 : 1;
}
