#include "services/ekf/model/error_state.hpp"

#include <gtest/gtest.h>

#include "tests/services/ekf/model/model_fixture.hpp"

namespace curbstone::ekf::model {
namespace {

using ErrorStateTest = ModelTest;

TEST_F(ErrorStateTest, MinusUndoesPlus) {
  ErrorVector error = ErrorVector::Random() * 0.5;
  EXPECT_LT((minus(plus(state_, error), state_) - error).norm(), 1e-12);
}

}  // namespace
}  // namespace curbstone::ekf::model
