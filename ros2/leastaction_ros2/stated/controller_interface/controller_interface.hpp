#include "../control.hpp"
