#include "lib/material/material.h"
