// Scores of a detector's answers, as defined in tools/statistics/confusion.h. `counts`:
// [truth][class]; null: undefined.

const contact = [1, 2, 3], slip = [2, 3];
const share = (part, all) => all ? part / all : null;
const samples = (counts, truths) => d3.sum(truths, truth => d3.sum(counts[truth]));
// The states in contact that occur.
const occurring = counts => contact.filter(truth => d3.sum(counts[truth]) > 0);
const recall = (counts, truth) => share(counts[truth][truth], d3.sum(counts[truth]));

sb.scores = {
  // Sum of the counts of trials with a detector.
  pooled: trials => d3.range(4).map(truth => d3.range(4).map(seen => d3.sum(trials, trial => trial.detector.confusion[truth][seen]))),
  recall,
  recallOfSlip: counts => share(d3.sum(slip, truth => d3.sum(slip, seen => counts[truth][seen])), samples(counts, slip)),
  balancedAccuracy: counts => share(d3.sum(occurring(counts), truth => recall(counts, truth)), occurring(counts).length),
  constantBalancedAccuracy: counts => share(1, occurring(counts).length),
  accuracy: counts => share(d3.sum(contact, truth => counts[truth][truth]), samples(counts, contact)),
  constantAccuracy: counts => share(d3.max(contact, truth => d3.sum(counts[truth])), samples(counts, contact)),
};
