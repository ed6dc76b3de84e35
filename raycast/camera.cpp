#include "raycast/camera.h"
