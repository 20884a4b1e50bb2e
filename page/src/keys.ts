// The keyboard. Controls keep the keys that are theirs: a button its space, a list its arrows.
import { byId } from './dom';
import type { Player } from './player';

export function bindKeys(player: Player | null, toggleTheme: () => void): void {
  const help = byId<HTMLDialogElement>('help');
  const showHelp = (): void => help.showModal();
  byId('help-open').addEventListener('click', showHelp);
  byId('help-close').addEventListener('click', () => help.close());

  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (help.open) {
      if (event.key === '?') help.close();
      return;
    }
    const at = event.target as HTMLElement;
    const act = actionOf(event, at);
    if (!act) return;
    event.preventDefault();
    act();
  });

  const actionOf = (event: KeyboardEvent, at: HTMLElement): (() => void) | undefined => {
    if (event.key === '?') return showHelp;
    if (event.key === 't') return toggleTheme;
    if (!player || at instanceof HTMLSelectElement) return undefined;
    const scrolls = at.classList.contains('scroll');
    switch (event.key) {
      case ' ': return at instanceof HTMLButtonElement ? undefined : () => player.toggle();
      case 'ArrowLeft': return () => player.seekBy(event.shiftKey ? -10 : -1);
      case 'ArrowRight': return () => player.seekBy(event.shiftKey ? 10 : 1);
      case 'Home': return scrolls ? undefined : () => player.seek(0);
      case 'n': return () => player.seekMark(1);
      case 'p': return () => player.seekMark(-1);
      case '=':
      case '+': return () => player.faster(1);
      case '-': return () => player.faster(-1);
      default: return undefined;
    }
  };
}
