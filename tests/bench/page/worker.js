// Requests a number of rounds, measures them, and sends the report with the next request, until
// the number is 0.
import init, { Bench } from './pkg/stepscope_bench.js';

const ask = async (report) => Number(await (await fetch('/rounds', { method: 'POST', body: report })).text());

try {
  await init();
  const bench = new Bench();
  for (let rounds = await ask(''); rounds > 0; ) {
    rounds = await ask(bench.rounds(rounds));
  }
} catch (error) {
  await fetch('/failed', { method: 'POST', body: String(error?.stack ?? error) });
}
