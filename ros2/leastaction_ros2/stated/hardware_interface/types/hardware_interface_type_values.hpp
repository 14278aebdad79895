#include "../../control.hpp"
