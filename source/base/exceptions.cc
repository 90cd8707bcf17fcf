#include <selkie/base/exceptions.h>
