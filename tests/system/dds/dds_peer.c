// dds_peer hear DOMAIN NAMESPACE PARTITION SPEED-RPM: a participant made with Cyclone DDS, from its own generator and
// from the same IDL. Hears every topic of the bridge until SIGTERM, compares each member with what telemetry_source
// told (told.h), and prints a JSON object a topic. PARTITION '-': none. dds_peer speak DOMAIN NAMESPACE PARTITION
// SPEED-RPM COUNT: says COUNT samples of every type instead, once somebody listens to all of them. Prints "matched N"
// as soon as every topic has met N others.
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "peer_topics.h"
#include "telemetry.h"

static void fail(const char* what) {
  fprintf(stderr, "dds_peer: %s\n", what);
  exit(1);
}

// The fewest that any topic has met; printed when it grows.
static void say_matched(unsigned met) {
  static unsigned said;
  if (met <= said) return;
  said = met;
  printf("matched %u\n", met);
  fflush(stdout);
}

static void hear(void) {
  for (int end = 0; !end;) {
    dds_sleepfor(DDS_MSECS(2));
    sigset_t pending;
    sigpending(&pending);
    end = sigismember(&pending, SIGTERM);
    unsigned met = 1000;
    for (Topic* topic = topics; topic < topics + TOPICS; ++topic) {
      dds_subscription_matched_status_t status;
      if (dds_get_subscription_matched_status(topic->entity, &status) != DDS_RETCODE_OK) fail("no status");
      if (status.total_count < met) met = status.total_count;
      void* samples[64] = {NULL};
      dds_sample_info_t info[64];
      for (int got; (got = dds_take(topic->entity, samples, info, 64, 64)) > 0;
           dds_return_loan(topic->entity, samples, got))
        for (int i = 0; i < got; ++i) {
          if (!info[i].valid_data) continue;
          const long n = topic->number(samples[i]);
          if (topic->count++ == 0)
            topic->first = n;
          else if (n <= topic->last)
            ++topic->old;
          else
            topic->missing += n - topic->last - 1;
          if (n > topic->last || topic->count == 1) topic->last = n;
          if (!topic->told(samples[i], n)) ++topic->wrong;
        }
    }
    say_matched(met);
  }
  for (const Topic* topic = topics; topic < topics + TOPICS; ++topic)
    printf(
        "{\"topic\": \"%s\", \"count\": %ld, \"first\": %ld, \"last\": %ld, \"missing\": %ld, \"old\": %ld, \"wrong\": "
        "%ld}\n",
        topic->name, topic->count, topic->first, topic->last, topic->missing, topic->old, topic->wrong);
}

static void speak(long count) {
  for (unsigned met = 0; met == 0; say_matched(met)) {
    dds_sleepfor(DDS_MSECS(10));
    met = 1000;
    for (const Topic* topic = topics; topic < topics + TOPICS; ++topic) {
      dds_publication_matched_status_t status;
      if (dds_get_publication_matched_status(topic->entity, &status) != DDS_RETCODE_OK) fail("no status");
      if (status.current_count < met) met = status.current_count;
    }
  }
  for (long n = 0; n < count; ++n) {
    for (const Topic* topic = topics; topic < topics + TOPICS; ++topic) {
      void* sample = dds_alloc(topic->type->m_size);
      memset(sample, 0, topic->type->m_size);
      *(char**)((char*)sample + offsetof(std_msgs_msg_dds__Header_, frame_id)) = "";  // every type begins with a header
      topic->make(sample, n);
      if (dds_write(topic->entity, sample) != DDS_RETCODE_OK) fail("could not write");
      dds_free(sample);
    }
    dds_sleepfor(DDS_MSECS(5));
  }
  for (const Topic* topic = topics; topic < topics + TOPICS; ++topic)
    if (dds_wait_for_acks(topic->entity, DDS_SECS(10)) != DDS_RETCODE_OK) fail("not everything was acknowledged");
}

int main(int argc, char** argv) {
  if (argc < 6) fail("wrong usage");
  const bool hears = strcmp(argv[1], "hear") == 0;
  speed_rpm = atof(argv[5]);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, NULL);
  const dds_entity_t participant = dds_create_participant((dds_domainid_t)atoi(argv[2]), NULL, NULL);
  if (participant < 0) fail("no participant");
  dds_qos_t* qos = dds_create_qos();
  if (strcmp(argv[4], "-") != 0) dds_qset_partition1(qos, argv[4]);
  const dds_entity_t group =
      hears ? dds_create_subscriber(participant, qos, NULL) : dds_create_publisher(participant, qos, NULL);
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 200);
  for (Topic* topic = topics; topic < topics + TOPICS; ++topic) {
    char name[256];
    const bool of_all = strcmp(topic->name, "diagnostics") == 0;
    snprintf(name, sizeof name, "rt/%s%s%s", of_all ? "" : argv[3], of_all ? "" : "/", topic->name);
    const dds_entity_t named = dds_create_topic(participant, topic->type, name, NULL, NULL);
    topic->entity = hears ? dds_create_reader(group, named, qos, NULL) : dds_create_writer(group, named, qos, NULL);
    if (topic->entity < 0) fail("no reader or writer");
  }
  if (hears)
    hear();
  else
    speak(argc > 6 ? atol(argv[6]) : 1);
  dds_delete(participant);
  return 0;
}
