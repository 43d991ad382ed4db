#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

namespace {

Fault drive(std::string name, std::string words, std::vector<std::string> arguments) {
  return {.sensor = "drive", .name = std::move(name), .words = std::move(words), .drive = std::move(arguments)};
}

}  // namespace

std::vector<Fault> faultless_drives() {
  return {
      drive("manoeuvres", "at its stops it backs up, turns on the spot, drives a leg backwards",
            {"--seed", "31", "--seconds", "150", "--set", "manoeuvres=true"}),
      drive("crawl", "at 0.3 m/s", {"--seed", "32", "--seconds", "80", "--set", "speed=0.3"}),
      drive("fast", "at 12 m/s, with 3 m/s^2",
            {"--seed", "33", "--seconds", "60", "--set", "speed=12", "acceleration=3"}),
      drive("sets off at once", "without a standstill at the start",
            {"--seed", "34", "--seconds", "60", "--set", "standstill=0"}),
      drive("10 Hz", "the LiDAR turns 600 times a minute; with manoeuvres at 1.5 m/s",
            {"--seed", "35", "--seconds", "100", "--set", "rpm=600", "manoeuvres=true", "speed=1.5"}),
      drive("5 Hz", "the LiDAR turns 300 times a minute", {"--seed", "36", "--seconds", "60", "--set", "rpm=300"}),
      drive("wheels spin", "30 times a minute one or both turn half as much again, or half as much",
            {"--seed", "37", "--seconds", "60", "--set", "wheels.slips_per_minute=30", "wheels.slip=0.5"}),
      drive("Helios 32", "another LiDAR, with 32 beams; with manoeuvres",
            {"--seed", "38", "--seconds", "100", "--lidar", "helios32", "--set", "manoeuvres=true"}),
      drive("VLP-16", "another LiDAR", {"--seed", "39", "--seconds", "60", "--lidar", "vlp16"}),
      drive("hills", "the street rises and falls by up to 26 %",
            {"--seed", "52", "--seconds", "60", "--set", "steepness=0.45"}),
      drive("bare street", "nothing but curbs for 100 m", {"--seed", "40", "--straight", "200"}),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
