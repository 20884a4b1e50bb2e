// The topics as dds_peer hears and says them: made by Cyclone DDS's generator, judged by told.h.
#ifndef STILLCUT_TESTS_DDS_PEER_TOPICS_H
#define STILLCUT_TESTS_DDS_PEER_TOPICS_H

#include <stdbool.h>

#include "dds/dds.h"

typedef struct {
  const char* name;
  const dds_topic_descriptor_t* type;
  long (*number)(const void*);      // of a sample
  bool (*told)(const void*, long);  // are its members those of that number
  void (*make)(void*, long);        // a sample of that number
  dds_entity_t entity;
  long count, wrong, missing, old, first, last;
} Topic;

enum { TOPICS = 8 };
extern Topic topics[TOPICS];
extern double speed_rpm;  // that the source told

#endif
